// GPL-2.0-or-later. Flood fill from entities: leaks, leafs outside, numbers of clusters and areas.
#include "q3map2/tree/flood.h"

#include "common/error.h"
#include "common/text/text.h"
#include "q3map2/bspfile/bspfile_ibsp.h"
#include "q3map2/bspfile/light_keys.h"
#include "q3map2/bspfile/map_keys.h"
#include "q3map2/tree/portals.h"

#include <algorithm>
#include <utility>

namespace q3 {

// ---- Flood fill from entities: finds leaks, makes leafs outside opaque ----

namespace {

/// Entities may stand exactly on a floor. Game units.
const Vec3f kLift{0, 0, 1};

/// Whether the flood starts at the entity. It does not at brush entities: their origin may be anywhere.
bool StartsFlood(const MapEntity &entity) {
    return !entity.pairs.pairs.empty() && entity.model < 0 && entity.brushes.empty() && entity.patches.empty() &&
           !EqualNoCase(entity.pairs.ClassName(), "_decal") && !entity.pairs.Value("model").starts_with('*');
}

/// The leaf on the other side of the portal.
int FarSide(const TreePortal &portal, int leaf) {
    return portal.nodes[0] == leaf ? portal.nodes[1] : portal.nodes[0];
}

/// Sets `floodSteps` of leafs to the number of leafs on the path from `start`, unless it is already as small.
void FloodSteps(Tree &tree, int start) {
    std::vector<int> frontier{start}; // leafs at `steps` leafs from the start
    for (int steps = 1; !frontier.empty(); steps++) {
        std::vector<int> reached;
        for (const int leaf : frontier) {
            int &floodSteps = tree.nodes[std::size_t(leaf)].floodSteps;
            if (floodSteps != 0 && floodSteps <= steps)
                continue;
            floodSteps = steps;
            for (const int portal : tree.nodes[std::size_t(leaf)].portals) {
                const int other = FarSide(tree.portals[std::size_t(portal)], leaf);
                if (!tree.nodes[std::size_t(other)].opaque)
                    reached.push_back(other);
            }
        }
        frontier = std::move(reached);
    }
}

/// Marks all leafs that are connected to `start` as leafs of a sky box.
void MarkSkyBox(Tree &tree, int start) {
    std::vector<int> pending{start};
    while (!pending.empty()) {
        const int leaf = pending.back();
        pending.pop_back();
        TreeNode &node = tree.nodes[std::size_t(leaf)];
        if (node.skyBox || node.opaque)
            continue;
        node.skyBox = true;
        for (const int portal : node.portals)
            pending.push_back(FarSide(tree.portals[std::size_t(portal)], leaf));
    }
}

/// Whether the entity shines from its origin: suns do not.
bool ShinesFromOrigin(const Entity &entity) {
    return IsLight(entity) && !EqualNoCase(entity.ClassName(), "light_environment") && keys::kSun.Number(entity) == 0;
}

/// Whether p is inside the brush, and it is solid and opaque.
bool InSolidBrush(const Brush &brush, const Vec3f &p, const PlaneTable &planes) {
    if (!brush.opaque || !(brush.compileFlags & C_SOLID))
        return false;
    return std::ranges::all_of(brush.sides, [&](const BrushSide &side) {
        return side.planeNum < 0 || planes[side.planeNum].Distance(Vec3d(p)) < 0;
    });
}

/// Warns of lights in opaque detail brushes. Their leafs are open, but the light stage treats them as solid.
void WarnOfLightsInDetail(const Map &map, const BspContext &context) {
    for (const MapEntity &entity : map.entities) {
        if (!ShinesFromOrigin(entity.pairs))
            continue;
        const Vec3f origin = entity.origin;
        for (const Brush &brush : map.entities.front().brushes) {
            if (!(brush.detail || HasFewSides(brush)) || !InSolidBrush(brush, origin, map.planes))
                continue;
            const std::string_view name = entity.pairs.Value("targetname");
            context.log.Warn(
                kLightInDetail,
                "{}: the {}{} at {:g} {:g} {:g} stands in a detail brush (entity {}, brush {}), which lets "
                "no light out; move it into the open",
                entity.MessagePrefix(), entity.pairs.ClassName(), name.empty() ? "" : fmt::format(" \"{}\"", name),
                origin.x, origin.y, origin.z, brush.settings.entity, brush.primitive);
            break;
        }
    }
}

/// isOpaque(p): whether p is in an opaque leaf.
template <typename Test> void WarnOfSolids(const Map &map, const BspContext &context, const Test &isOpaque) {
    WarnOfLightsInDetail(map, context);
    for (std::size_t i = 1; i < map.entities.size(); ++i)
        if (const MapEntity &entity = map.entities[i]; StartsFlood(entity) && isOpaque(entity.origin + kLift))
            context.log.Warn(kEntityInSolid, "{}: the {} stands in solid", entity.MessagePrefix(),
                             entity.pairs.ClassName());
}

} // namespace

Sealing FloodEntities(Tree &tree, const Map &map, const BspContext &context, SolidWarnings warnings) {
    context.log.VerboseSection("FloodEntities");
    const auto leafAt = [&](const Vec3f &p) { return tree.LeafAt(p, map.planes); };
    if (warnings == SolidWarnings::Print)
        WarnOfSolids(map, context, [&](const Vec3f &p) { return tree.nodes[std::size_t(leafAt(p))].opaque; });
    bool anyFlood = false;
    for (std::size_t i = 1; i < map.entities.size(); i++) {
        const MapEntity &entity = map.entities[i];
        if (!StartsFlood(entity))
            continue;
        const int leaf = leafAt(entity.origin + kLift);
        if (tree.nodes[std::size_t(leaf)].opaque)
            continue;
        tree.nodes[std::size_t(leaf)].floodEntity = int(i);
        FloodSteps(tree, leaf);
        if (EqualNoCase(entity.pairs.ClassName(), "_skybox"))
            MarkSkyBox(tree, leaf);
        anyFlood = true;
    }
    const auto flooded =
        std::count_if(tree.nodes.begin(), tree.nodes.end(), [](const TreeNode &node) { return node.floodSteps != 0; });
    context.log.VerboseCount(flooded, "flooded leafs");
    if (!anyFlood) {
        context.log.Verbose("no entity is in open space: nothing can be filled\n");
        return Sealing::Empty;
    }
    const MapEntity &world = map.entities.front();
    const bool leaked = tree.outside >= 0 && tree.nodes[std::size_t(tree.outside)].floodSteps != 0;
    const bool ignored = keys::kIgnoreLeaks.Flag(world.pairs);
    return leaked && !ignored ? Sealing::Leaked : Sealing::Sealed;
}

// ---- Whether other entities flood the same leafs ----

int FloodRegions::RegionAt(const Vec3f &p) const {
    std::size_t node = 0;
    while (nodes[node].children[0] >= 0) // as Tree::LeafAt
        node = std::size_t(nodes[node].children[nodes[node].plane.Distance(Vec3d(p)) >= 0 ? 0 : 1]);
    return nodes[node].region;
}

FloodRegions FloodRegionsOf(const Tree &tree, const PlaneTable &planes) {
    FloodRegions regions;
    regions.nodes.resize(tree.nodes.size());
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        const TreeNode &node = tree.nodes[i];
        if (!node.IsLeaf()) {
            regions.nodes[i].plane = planes[node.planeNum];
            regions.nodes[i].children = {node.children[0], node.children[1]};
        } else if (!node.opaque && regions.nodes[i].region < 0) {
            const auto region = std::int32_t(regions.flooded.size());
            regions.flooded.push_back(node.floodSteps != 0);
            std::vector<std::size_t> pending{i};
            while (!pending.empty()) {
                const std::size_t leaf = pending.back();
                pending.pop_back();
                if (tree.nodes[leaf].opaque || regions.nodes[leaf].region >= 0)
                    continue;
                regions.nodes[leaf].region = region;
                for (const int portal : tree.nodes[leaf].portals)
                    pending.push_back(std::size_t(FarSide(tree.portals[std::size_t(portal)], int(leaf))));
            }
        }
    }
    return regions;
}

bool FloodsSameRegions(const FloodRegions &regions, const Map &map) {
    std::vector<std::uint8_t> flooded(regions.flooded.size());
    for (std::size_t i = 1; i < map.entities.size(); ++i)
        if (StartsFlood(map.entities[i]))
            if (const int region = regions.RegionAt(map.entities[i].origin + kLift); region >= 0)
                flooded[std::size_t(region)] = 1;
    return flooded == regions.flooded;
}

void WarnOfEntitiesInSolid(const FloodRegions &regions, const Map &map, const BspContext &context) {
    WarnOfSolids(map, context, [&](const Vec3f &p) { return regions.RegionAt(p) < 0; });
}

// ---- Leafs outside, and the leak line ----

void FillOutside(Tree &tree, const BspContext &context) {
    context.log.VerboseSection("FillOutside");
    long long solid = 0, filled = 0, inside = 0;
    for (int i = 0; i < int(tree.nodes.size()); i++) {
        TreeNode &node = tree.nodes[std::size_t(i)];
        if (!node.IsLeaf() || i == tree.outside)
            continue;
        if (node.opaque)
            solid++;
        else if (node.floodSteps == 0)
            node.opaque = true, filled++;
        else
            inside++;
    }
    context.log.VerboseCount(solid, "solid leafs");
    context.log.VerboseCount(filled, "leafs filled");
    context.log.VerboseCount(inside, "inside leafs");
}

namespace {

struct LeakPath {
    std::vector<int> portals;
    int entity = -1;
};

/// The path from outside to an entity: each step goes to the neighbor with the least `floodSteps`.
LeakPath FindLeakPath(const Tree &tree) {
    LeakPath path;
    if (tree.outside < 0 || tree.nodes[std::size_t(tree.outside)].floodSteps == 0)
        return path;
    int leaf = tree.outside;
    while (tree.nodes[std::size_t(leaf)].floodSteps > 1) {
        int next = -1, through = -1, steps = tree.nodes[std::size_t(leaf)].floodSteps;
        for (const int number : tree.nodes[std::size_t(leaf)].portals) {
            const int other = FarSide(tree.portals[std::size_t(number)], leaf);
            const int floodSteps = tree.nodes[std::size_t(other)].floodSteps;
            if (floodSteps != 0 && floodSteps < steps)
                next = other, through = number, steps = floodSteps;
        }
        if (next < 0)
            return {};
        path.portals.push_back(through);
        leaf = next;
    }
    path.entity = tree.nodes[std::size_t(leaf)].floodEntity;
    return path;
}

} // namespace

int LeakedEntity(const Tree &tree) {
    return FindLeakPath(tree).entity;
}

std::vector<Vec3f> LeakLine(const Tree &tree, const Map &map) {
    const LeakPath path = FindLeakPath(tree);
    std::vector<Vec3f> line;
    for (const int number : path.portals) {
        const Polygon &polygon = tree.portals[std::size_t(number)].polygon;
        Vec3d sum;
        for (const Vec3f &p : polygon)
            sum += Vec3d(p);
        line.emplace_back(sum / double(polygon.size()));
    }
    if (path.entity >= 0)
        line.push_back(map.entities[std::size_t(path.entity)].origin);
    return line;
}

std::string LeakFileText(const std::vector<Vec3f> &line) {
    std::string text;
    for (const Vec3f &p : line)
        text += fmt::format("{:f} {:f} {:f}\n", p.x, p.y, p.z);
    return text;
}

// ---- Numbers of clusters and areas ----

int NumberClusters(Tree &tree, bool deep) {
    int count = 0;
    struct Visit {
        int node = 0;
        int group = -1; ///< the detail node above; its leafs share a number
    };
    std::vector<int> shared(tree.nodes.size(), -1); // by group: the number of its leafs; -1: none yet
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
                pending.push_back(FarSide(portal, leaf));
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

/// Whether the portal is a part of this side of an area portal brush.
bool IsOfAreaPortal(const TreePortal &portal, const Brush &brush, const BrushSide &side) {
    constexpr float kSlack = 1; // a portal may reach this far beyond the brush; game units
    if (portal.polygon.empty() || !(portal.compileFlags & C_AREAPORTAL) ||
        EvenPlane(portal.planeNum) != EvenPlane(side.planeNum))
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
