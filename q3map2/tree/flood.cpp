// GPL-2.0-or-later. Flood fill from entities: finds leaks, makes leafs outside opaque.
#include "q3map2/tree/flood.h"

#include "common/text/text.h"
#include "q3map2/bspfile/light_curve_keys.h"
#include "q3map2/bspfile/surface_keys.h"

#include <algorithm>

namespace q3 {

namespace {

/// Whether the flood starts at the entity. It does not at brush entities: their origin may be anywhere.
bool Floods(const MapEntity &entity) {
    return !entity.pairs.pairs.empty() && entity.model < 0 && entity.brushes.empty() && entity.patches.empty() &&
           !EqualNoCase(entity.pairs.ClassName(), "_decal") && !entity.pairs.Value("model").starts_with('*');
}

int FarSide(const TreePortal &portal, int leaf) {
    return portal.nodes[0] == leaf ? portal.nodes[1] : portal.nodes[0];
}

/// Sets `occupied` of leafs to the number of leafs on the path from `start`, unless it is already as small.
void FloodSteps(Tree &tree, int start) {
    std::vector<int> ring{start};
    for (int steps = 1; !ring.empty(); steps++) {
        std::vector<int> reached;
        for (const int leaf : ring) {
            int &occupied = tree.nodes[std::size_t(leaf)].occupied;
            if (occupied != 0 && occupied <= steps)
                continue;
            occupied = steps;
            for (const int portal : tree.nodes[std::size_t(leaf)].portals) {
                const int other = FarSide(tree.portals[std::size_t(portal)], leaf);
                if (!tree.nodes[std::size_t(other)].opaque)
                    reached.push_back(other);
            }
        }
        ring = std::move(reached);
    }
}

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
    return StartsWithNoCase(entity.ClassName(), "light") && !EqualNoCase(entity.ClassName(), "light_environment") &&
           keys::kSun.Number(entity) == 0;
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
        const Vec3f origin = entity.Origin();
        for (const Brush &brush : map.entities.front().brushes) {
            if (!brush.detail || !InSolidBrush(brush, origin, map.planes))
                continue;
            const std::string_view name = entity.pairs.Value("targetname");
            context.log.Warn(
                "light in detail brush",
                "{}: the {}{} at {:g} {:g} {:g} stands in a detail brush (entity {}, brush {}), which lets "
                "no light out; move it into the open",
                entity.MessagePrefix(), entity.pairs.ClassName(), name.empty() ? "" : fmt::format(" \"{}\"", name),
                origin.x, origin.y, origin.z, brush.settings.entity, brush.primitive);
            break;
        }
    }
}

} // namespace

Sealing FloodEntities(Tree &tree, const Map &map, const BspContext &context, bool warn) {
    context.log.VerboseSection("FloodEntities");
    if (warn)
        WarnOfLightsInDetail(map, context);
    bool inside = false;
    for (std::size_t i = 1; i < map.entities.size(); i++) {
        const MapEntity &entity = map.entities[i];
        if (!Floods(entity))
            continue;
        const int leaf = tree.LeafAt(entity.Origin() + Vec3f(0, 0, 1), map.planes);
        if (tree.nodes[std::size_t(leaf)].opaque) {
            if (warn)
                context.log.Warn("entity in solid", "{}: the {} stands in solid", entity.MessagePrefix(),
                                 entity.pairs.ClassName());
            continue;
        }
        tree.nodes[std::size_t(leaf)].occupant = int(i);
        FloodSteps(tree, leaf);
        if (EqualNoCase(entity.pairs.ClassName(), "_skybox"))
            MarkSkyBox(tree, leaf);
        inside = true;
    }
    const auto flooded =
        std::count_if(tree.nodes.begin(), tree.nodes.end(), [](const TreeNode &node) { return node.occupied != 0; });
    context.log.VerboseCount(flooded, "flooded leafs");
    if (!inside) {
        context.log.Verbose("no entity stands in the open: nothing can be filled\n");
        return Sealing::Empty;
    }
    const MapEntity &world = map.entities.front();
    const bool leaked = tree.outside >= 0 && tree.nodes[std::size_t(tree.outside)].occupied != 0;
    const bool ignored = keys::kIgnoreLeaks.Flag(world.pairs);
    return leaked && !ignored ? Sealing::Leaked : Sealing::Sealed;
}

void FillOutside(Tree &tree, const BspContext &context) {
    context.log.VerboseSection("FillOutside");
    long long solid = 0, filled = 0, inside = 0;
    for (int i = 0; i < int(tree.nodes.size()); i++) {
        TreeNode &node = tree.nodes[std::size_t(i)];
        if (!node.IsLeaf() || i == tree.outside)
            continue;
        if (node.opaque)
            solid++;
        else if (node.occupied == 0)
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

/// The path from outside to an entity: each step goes to the neighbor with the least `occupied`.
LeakPath FindLeakPath(const Tree &tree) {
    LeakPath path;
    if (tree.outside < 0 || tree.nodes[std::size_t(tree.outside)].occupied == 0)
        return path;
    int leaf = tree.outside;
    while (tree.nodes[std::size_t(leaf)].occupied > 1) {
        int next = -1, through = -1, steps = tree.nodes[std::size_t(leaf)].occupied;
        for (const int number : tree.nodes[std::size_t(leaf)].portals) {
            const int other = FarSide(tree.portals[std::size_t(number)], leaf);
            const int occupied = tree.nodes[std::size_t(other)].occupied;
            if (occupied != 0 && occupied < steps)
                next = other, through = number, steps = occupied;
        }
        if (next < 0)
            return {};
        path.portals.push_back(through);
        leaf = next;
    }
    path.entity = tree.nodes[std::size_t(leaf)].occupant;
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
        line.push_back(map.entities[std::size_t(path.entity)].Origin());
    return line;
}

std::string LeakFileText(const std::vector<Vec3f> &line) {
    std::string text;
    for (const Vec3f &p : line)
        text += fmt::format("{:f} {:f} {:f}\n", p.x, p.y, p.z);
    return text;
}

} // namespace q3
