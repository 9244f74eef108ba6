// GPL-2.0-or-later. Numbers of clusters and areas.
#include "q3map2/tree/areas.h"

#include "common/error.h"
#include "q3map2/bspfile/bsp_layout.h"
#include "q3map2/tree/portals.h"

#include <utility>

namespace q3 {

int NumberClusters(Tree &tree, bool deep) {
    int count = 0;
    struct Visit {
        int node = 0;
        int group = -1; ///< the detail node above; its leafs share a number
    };
    std::vector<int> shared(tree.nodes.size(), -1);
    std::vector<Visit> pending{{tree.head, -1}};
    while (!pending.empty()) {
        Visit at = pending.back();
        pending.pop_back();
        TreeNode &node = tree.nodes[std::size_t(at.node)];
        if (!node.IsLeaf()) {
            if (deep && !node.structural && at.group < 0)
                at.group = at.node;
            pending.push_back({node.children[1], at.group});
            pending.push_back({node.children[0], at.group});
        } else if (node.opaque)
            node.cluster = -1;
        else if (at.group < 0)
            node.cluster = count++;
        else {
            int &number = shared[std::size_t(at.group)];
            if (number < 0)
                number = count++;
            node.cluster = number;
        }
    }
    if (count > kMaxClusters)
        throw Error("the map has {} clusters, expected at most {}: larger blocks (world key _blocksize) and more "
                    "detail brushes make fewer",
                    count, kMaxClusters);
    return count;
}

namespace {

/// Leafs of the tree, front first.
std::vector<int> LeafsInOrder(const Tree &tree) {
    std::vector<int> leafs, pending{tree.head};
    while (!pending.empty()) {
        const int at = pending.back();
        pending.pop_back();
        const TreeNode &node = tree.nodes[std::size_t(at)];
        if (node.IsLeaf()) {
            leafs.push_back(at);
            continue;
        }
        pending.push_back(node.children[1]);
        pending.push_back(node.children[0]);
    }
    return leafs;
}

/// Sets the area of all leafs connected to `start`. If one of them is a sky box leaf, all become sky box leafs.
void FloodArea(Tree &tree, int start, int area) {
    std::vector<int> members, pending{start};
    bool skyBox = false;
    while (!pending.empty()) {
        const int leaf = pending.back();
        pending.pop_back();
        TreeNode &node = tree.nodes[std::size_t(leaf)];
        if (node.area >= 0)
            continue;
        node.area = area;
        members.push_back(leaf);
        skyBox = skyBox || node.skyBox;
        for (const int number : node.portals) {
            const TreePortal &portal = tree.portals[std::size_t(number)];
            if (IsPassable(tree, portal) && !(portal.compileFlags & C_AREAPORTAL))
                pending.push_back(portal.nodes[0] == leaf ? portal.nodes[1] : portal.nodes[0]);
        }
    }
    for (const int leaf : members)
        tree.nodes[std::size_t(leaf)].skyBox = skyBox;
}

} // namespace

int FloodAreas(Tree &tree) {
    int count = 0;
    const std::vector<int> leafs = LeafsInOrder(tree);
    for (const int leaf : leafs)
        tree.nodes[std::size_t(leaf)].area = -1;
    for (const int leaf : leafs)
        if (!tree.nodes[std::size_t(leaf)].opaque && tree.nodes[std::size_t(leaf)].area < 0)
            FloodArea(tree, leaf, count++);
    return count;
}

namespace {

/// Whether the portal lies on the side of a brush with these bounds that makes it an area portal.
bool IsOfAreaPortal(const TreePortal &portal, const Brush &brush, const BrushSide &side) {
    constexpr float kSlack = 1; // a portal may reach this far beyond the brush; game units
    if (portal.polygon.empty() || !(portal.compileFlags & C_AREAPORTAL) || (portal.planeNum ^ side.planeNum) > 1)
        return false;
    return WindingBounds(portal.polygon).Touches(brush.bounds, kSlack);
}

} // namespace

std::vector<int> IdleAreaPortals(const Tree &tree, const MapEntity &world) {
    const auto area = [&](int leaf) { return tree.nodes[std::size_t(leaf)].area; };
    const auto separates = [&](const Brush &brush) {
        for (const BrushSide &side : brush.sides)
            if (side.compileFlags & C_AREAPORTAL)
                for (const TreePortal &portal : tree.portals)
                    if (IsOfAreaPortal(portal, brush, side) && IsPassable(tree, portal) &&
                        area(portal.nodes[0]) != area(portal.nodes[1]))
                        return true;
        return false;
    };
    std::vector<int> idle;
    for (int i = 0; i < int(world.brushes.size()); ++i)
        if (const Brush &brush = world.brushes[std::size_t(i)];
            (brush.compileFlags & C_AREAPORTAL) && !separates(brush))
            idle.push_back(i);
    return idle;
}

} // namespace q3
