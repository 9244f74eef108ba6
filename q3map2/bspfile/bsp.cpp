// GPL-2.0-or-later. A compiled map in memory, and point queries on its BSP tree.
#include "q3map2/bspfile/bsp.h"

#include <algorithm>
#include <cmath>

namespace q3 {

std::int64_t Bsp::NamedPages() const {
    std::int64_t count = 0;
    for (const bspDrawSurface_t &surface : drawSurfaces)
        for (std::size_t slot = 0; slot < kStyles; ++slot)
            if (slot == 0 || surface.lightmapStyles[slot] != kNoStyle) // free slots may hold anything
                count = std::max(count, std::int64_t(surface.lightmapNum[slot]) + 1);
    return count;
}

namespace {

BspTree::Node ReadNode(const Bsp &bsp, std::size_t number) {
    const bspNode_t &node = bsp.nodes[number];
    const bspPlane_t &plane = bsp.planes[std::size_t(node.planeNum)];
    return {Vec3f(plane.normal), plane.dist, {node.children[0], node.children[1]}};
}

/// nodeOf(child) and clusterOf(leaf) read the tree, from a Bsp or from the copy in a BspTree.
template <typename NodeOf, typename ClusterOf>
int FindLeaf(const Vec3f &p, BspChild from, const NodeOf &nodeOf, const ClusterOf &clusterOf) {
    // Back children of nodes whose plane p is on: tried, the last one first, if the leaf found through the front
    // children is solid. A point on more than 64 planes forgets those after them.
    std::array<BspChild, 64> pending;
    std::size_t pendingCount = 0;
    BspChild child = from;
    int firstLeaf = -1;
    for (;;) {
        while (child >= 0) {
            const BspTree::Node &node = nodeOf(child);
            const float distance = Dot(node.normal, p) - node.dist;
            // Branches on purpose: the processor predicts them and runs ahead; children[distance < 0] would stall until
            // the distance is known.
            if (distance > kOnPlane)
                child = node.children[0];
            else if (distance < -kOnPlane)
                child = node.children[1];
            else {
                if (pendingCount < pending.size())
                    pending[pendingCount++] = node.children[1];
                child = node.children[0];
            }
        }
        const int leaf = LeafOf(child);
        if (firstLeaf < 0)
            firstLeaf = leaf;
        if (clusterOf(leaf) != kSolidCluster)
            return leaf;
        if (pendingCount == 0)
            return firstLeaf;
        child = pending[--pendingCount];
    }
}

} // namespace

int LeafAt(const Bsp &bsp, const Vec3f &p) {
    return FindLeaf(
        p, RootOf(bsp), [&](BspChild child) { return ReadNode(bsp, std::size_t(child)); },
        [&](int leaf) { return bsp.leafs[std::size_t(leaf)].cluster; });
}

BspTree::BspTree(const Bsp &bsp) {
    nodes_.reserve(bsp.nodes.size());
    for (std::size_t i = 0; i < bsp.nodes.size(); ++i)
        nodes_.push_back(ReadNode(bsp, i));
    clusters_.reserve(bsp.leafs.size());
    for (const bspLeaf_t &leaf : bsp.leafs)
        clusters_.push_back(leaf.cluster);
}

int BspTree::LeafAt(const Vec3f &p) const {
    return FindLeaf(
        p, Root(), [&](BspChild child) -> const Node & { return NodeOf(child); },
        [&](int leaf) { return ClusterOf(leaf); });
}

} // namespace q3
