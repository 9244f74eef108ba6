// GPL-2.0-or-later. Worlds of boxes, and what the tree makes of them.
#include "tests/tree/tree_fixture.h"
#include "q3map2/map/map_brush.h"
#include "q3map2/tree/brush_filter.h"
#include "q3map2/tree/flood.h"
#include "q3map2/tree/portals.h"
#include "q3map2/tree/tree.h"
#include "q3map2/tree/visible_sides.h"

#include <algorithm>
#include <cstdio>

namespace q3::test {

World::World()
    : log([this](LogLevel, std::string_view line) { text += line; }, true), files_(log),
      shaders_(files_, *FindGame("quake3"), {}, log) {
    map.name = "test.map";
    map.entities.resize(1);
    map.World().pairs.Set("classname", "worldspawn");
    map.World().model = 0;
}

const ShaderInfo &World::Shader(std::uint32_t flags) {
    for (const ShaderInfo &shader : own_)
        if (shader.compileFlags == flags)
            return shader;
    own_.emplace_back().compileFlags = flags;
    own_.back().name = "textures/test/wall";
    return own_.back();
}

int World::AddBrush(const std::vector<Plane> &planes, std::uint32_t flags) {
    Brush brush;
    for (const Plane &plane : planes) {
        BrushSide &side = brush.sides.emplace_back();
        side.plane = plane;
        side.hasPlane = true;
        side.planeNum = map.planes.Find(plane.normal, plane.dist);
        side.compileFlags = C_SOLID | flags;
        side.shader = &Shader(side.compileFlags);
    }
    brush.compileFlags = C_SOLID | flags;
    brush.opaque = !(flags & C_TRANSLUCENT);
    brush.detail = (flags & C_DETAIL) || (!brush.opaque && !(flags & C_STRUCTURAL));
    brush.primitive = int(Brushes().size());
    EXPECT_TRUE(MakeBrushWindings(brush, map.planes));
    AddBrushBevels(brush, map.planes, 0, Game().bevelSurfaceFlags);
    const int primitive = brush.primitive;
    if (brush.opaque)
        Brushes().push_front(std::move(brush));
    else
        Brushes().push_back(std::move(brush));
    return primitive;
}

std::vector<Plane> BoxPlanes(const Vec3d &mins, const Vec3d &maxs) {
    std::vector<Plane> planes;
    for (std::size_t axis = 0; axis < 3; axis++)
        for (const double sign : {-1.0, 1.0}) {
            Plane &plane = planes.emplace_back();
            plane.normal[axis] = sign;
            plane.dist = sign < 0 ? -mins[axis] : maxs[axis];
        }
    return planes;
}

int World::AddBox(const Vec3d &mins, const Vec3d &maxs, std::uint32_t flags) {
    return AddBrush(BoxPlanes(mins, maxs), flags);
}

void World::AddRoom(const Vec3d &mins, const Vec3d &maxs, double thickness) {
    const double t = thickness;
    AddBox({mins.x - t, mins.y - t, mins.z - t}, {mins.x, maxs.y + t, maxs.z + t});
    AddBox({maxs.x, mins.y - t, mins.z - t}, {maxs.x + t, maxs.y + t, maxs.z + t});
    AddBox({mins.x, mins.y - t, mins.z - t}, {maxs.x, mins.y, maxs.z + t});
    AddBox({mins.x, maxs.y, mins.z - t}, {maxs.x, maxs.y + t, maxs.z + t});
    AddBox({mins.x, mins.y, mins.z - t}, {maxs.x, maxs.y, mins.z});
    AddBox({mins.x, mins.y, maxs.z}, {maxs.x, maxs.y, maxs.z + t});
}

void World::AddEntity(std::string_view className, const Vec3f &origin) {
    MapEntity &entity = map.entities.emplace_back();
    entity.pairs.Set("classname", className);
    entity.pairs.Set("origin", fmt::format("{} {} {}", origin.x, origin.y, origin.z));
    entity.origin = origin;
    entity.number = int(map.entities.size()) - 1;
}

Compiled World::Compile() {
    const BspContext context = Context();
    Compiled made;
    const auto grow = [&](Tree &tree, const std::vector<TreeFace> &faces) {
        tree = BuildTree(faces, map.blockSize, map.planes, context);
        MakePortals(tree, map.planes, context);
        FilterStructuralBrushes(map.World(), tree, map.planes, context);
        made.sealing = FloodEntities(tree, map, context);
        if (made.sealing == Sealing::Sealed)
            FillOutside(tree, context);
    };
    made.firstFaces = StructuralFaces(map.World(), context);
    grow(made.first, made.firstFaces);
    CullSides(map.World(), map.planes, context);
    made.parts = ClipSidesIntoTree(map.World(), made.first, map.planes, context);
    made.secondFaces = VisibleFaces(map.World(), context);
    grow(made.second, made.secondFaces);
    made.clusters = NumberClusters(made.second, options.deep);
    made.portalFile = PortalFileText(made.second, made.clusters);
    std::sscanf(made.portalFile.c_str(), "PRT1 %*d %d %d", &made.visiblePortals, &made.solidFaces);
    made.areas = FloodAreas(made.second);
    FilterDetailBrushes(map.World(), made.second, map.planes, context);
    return made;
}

int World::IndexOf(int primitive) {
    for (std::size_t i = 0; i < Brushes().size(); i++)
        if (Brushes()[i].primitive == primitive)
            return int(i);
    return -1;
}

std::vector<int> Leafs(const Tree &tree) {
    std::vector<int> leafs;
    for (int i = 0; i < int(tree.nodes.size()); i++)
        if (tree.nodes[std::size_t(i)].IsLeaf() && i != tree.outside)
            leafs.push_back(i);
    return leafs;
}

double VolumeOf(const Tree &tree, int leaf) {
    double sum = 0;
    const TreeNode &node = tree.nodes[std::size_t(leaf)];
    const Vec3d center(node.bounds.Center());
    for (const int number : node.portals) {
        const TreePortal &portal = tree.portals[std::size_t(number)];
        // Inside is in front for the first of its leafs.
        const double height = portal.plane.Distance(center) * (portal.nodes[0] == leaf ? 1 : -1);
        sum += height * WindingArea(portal.polygon) / 3;
    }
    return sum;
}

int CountLeafs(const Tree &tree, bool (*wanted)(const TreeNode &)) {
    const std::vector<int> leafs = Leafs(tree);
    return int(
        std::count_if(leafs.begin(), leafs.end(), [&](int leaf) { return wanted(tree.nodes[std::size_t(leaf)]); }));
}

} // namespace q3::test
