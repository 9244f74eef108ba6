// GPL-2.0-or-later. Which sides split the tree, which are hidden, and what of them lies in the open.
#include "q3map2/tree/tree.h"
#include "q3map2/tree/visible_sides.h"
#include "tests/tree/tree_fixture.h"

#include <gmock/gmock.h>

namespace q3 {
namespace {

using test::BoxPlanes;
using test::Compiled;
using test::World;
using ::testing::HasSubstr;

/// -x +x -y +y -z +z
enum BoxSide : std::size_t { kLeft, kRight, kNear, kFar, kBottom, kTop };

BrushSide &SideOfBox(World &world, int primitive, BoxSide side) {
    return world.Brushes()[std::size_t(world.IndexOf(primitive))].sides[side];
}

int CulledCount(World &world) {
    int count = 0;
    for (const Brush &brush : world.Brushes())
        count +=
            int(std::count_if(brush.sides.begin(), brush.sides.end(), [](const auto &side) { return side.culled; }));
    return count;
}

struct TwoBoxes {
    World world;
    int small = -1, large = -1;
    /// The small one stands with its left side on the right side of the large one.
    explicit TwoBoxes(std::uint32_t smallFlags = 0, std::uint32_t largeFlags = 0) {
        large = world.AddBox({0, 0, 0}, {64, 64, 64}, largeFlags);
        small = world.AddBox({64, 16, 16}, {96, 48, 48}, smallFlags);
    }
    void Cull() { CullSides(world.map.World(), world.map.planes, world.Context()); }
};

TEST(CullSides, HidesASideOnAnother) {
    TwoBoxes boxes;
    boxes.Cull();
    EXPECT_TRUE(SideOfBox(boxes.world, boxes.small, kLeft).culled);
    EXPECT_EQ(CulledCount(boxes.world), 1);
    EXPECT_THAT(boxes.world.text, HasSubstr("        1 hidden face culled\n        0 coincident faces culled\n"));
}

TEST(CullSides, SeeThroughAndUndrawnBrushesHideNothing) {
    for (const std::uint32_t flags : {C_TRANSLUCENT, C_NODRAW}) {
        TwoBoxes boxes(0, flags);
        boxes.Cull();
        EXPECT_EQ(CulledCount(boxes.world), 0);
    }
}

TEST(CullSides, SeeThroughSidesAreHidden) {
    TwoBoxes boxes(C_TRANSLUCENT, 0);
    boxes.Cull();
    EXPECT_TRUE(SideOfBox(boxes.world, boxes.small, kLeft).culled);
}

TEST(CullSides, WhatMovesOrIsOffsetStays) {
    for (const bool sprite : {true, false}) {
        TwoBoxes boxes;
        BrushSide &side = SideOfBox(boxes.world, boxes.small, kLeft);
        ShaderInfo shader = *side.shader;
        (sprite ? shader.autosprite : shader.geometry.polygonOffset) = true;
        side.shader = &shader;
        boxes.Cull();
        EXPECT_EQ(CulledCount(boxes.world), 0);
    }
}

TEST(CullSides, SidesThatStandOutStay) {
    World world;
    world.AddBox({0, 0, 0}, {64, 64, 64});
    world.AddBox({64, 16, 16}, {96, 80, 48}); // reaches beyond y = 64
    CullSides(world.map.World(), world.map.planes, world.Context());
    EXPECT_EQ(CulledCount(world), 0);
}

TEST(CullSides, EqualSidesFaceToFaceBothGo) {
    World world;
    const int a = world.AddBox({0, 0, 0}, {64, 64, 64}), b = world.AddBox({64, 0, 0}, {128, 64, 64});
    CullSides(world.map.World(), world.map.planes, world.Context());
    EXPECT_TRUE(SideOfBox(world, a, kRight).culled);
    EXPECT_TRUE(SideOfBox(world, b, kLeft).culled);
    EXPECT_EQ(CulledCount(world), 2);
}

TEST(CullSides, OfTwoEqualBrushesOneStays) {
    World world;
    world.AddBox({0, 0, 0}, {64, 64, 64});
    world.AddBox({0, 0, 0}, {64, 64, 64});
    CullSides(world.map.World(), world.map.planes, world.Context());
    for (std::size_t side = 0; side < 6; side++)
        EXPECT_NE(world.Brushes()[0].sides[side].culled, world.Brushes()[1].sides[side].culled);
}

TEST(CullSides, UndrawnSidesTakeNothingFromDrawnOnes) {
    World world;
    const int a = world.AddBox({0, 0, 0}, {64, 64, 64}), b = world.AddBox({64, 0, 0}, {128, 64, 64});
    SideOfBox(world, a, kRight).compileFlags |= C_NODRAW;
    SideOfBox(world, b, kTop).compileFlags |= C_NODRAW; // so neither brush hides sides of the other
    CullSides(world.map.World(), world.map.planes, world.Context());
    EXPECT_FALSE(SideOfBox(world, b, kLeft).culled);
    EXPECT_TRUE(SideOfBox(world, a, kRight).culled);
}

TEST(VisibleHull, IsThePartInTheOpen) {
    World world;
    world.AddRoom({-128, -128, 0}, {128, 128, 128});
    const int block = world.AddBox({0, 0, -8}, {64, 64, 32}); // stands in the floor
    world.AddEntity("info_player_start", {-64, -64, 32});
    const Compiled made = world.Compile();
    ASSERT_EQ(made.sealing, Sealing::Sealed);
    EXPECT_DOUBLE_EQ(WindingArea(SideOfBox(world, block, kRight).visibleHull), 64 * 32);
    EXPECT_DOUBLE_EQ(WindingArea(SideOfBox(world, block, kTop).visibleHull), 64 * 64);
    EXPECT_TRUE(SideOfBox(world, block, kBottom).visibleHull.empty());
    for (const Brush &brush : world.Brushes())
        for (const BrushSide &side : brush.sides)
            for (const Vec3f &p : side.visibleHull)
                EXPECT_TRUE((Boundsf{{-128, -128, 0}, {128, 128, 128}}.Contains(p)));
}

TEST(VisibleHull, JoinsPartsAndKeepsItsDirection) {
    World world;
    world.AddRoom({-128, -128, 0}, {128, 128, 128});
    const int floorNumber = 4;                 // of the room's boxes
    world.AddBox({-8, -128, 0}, {8, 128, 64}); // a low wall across, so that the floor is seen in two parts
    world.AddEntity("info_player_start", {-64, -64, 32});
    const Compiled made = world.Compile();
    ASSERT_EQ(made.sealing, Sealing::Sealed);
    const Polygon &hull = SideOfBox(world, floorNumber, kTop).visibleHull;
    EXPECT_DOUBLE_EQ(WindingArea(hull), 256 * 256);
    EXPECT_EQ(PlaneOf(hull).normal, Vec3d(0, 0, 1));
}

/// Visible parts of the floor of a room of 256 x 256 with a wall in it.
std::vector<Polygon> FloorParts(const std::vector<Plane> &wall, std::uint32_t flags) {
    World world;
    world.AddRoom({-128, -128, 0}, {128, 128, 128});
    world.AddBrush(wall, flags);
    world.AddEntity("info_player_start", {-96, -96, 32});
    world.AddEntity("info_player_start", {96, 96, 32});
    const Compiled made = world.Compile();
    EXPECT_EQ(made.sealing, Sealing::Sealed);
    const auto found = made.parts.find(&SideOfBox(world, 4, kTop));
    return found == made.parts.end() ? std::vector<Polygon>{} : found->second;
}

double AreaOf(const std::vector<Polygon> &parts) {
    double sum = 0;
    for (const Polygon &part : parts)
        sum += WindingArea(part);
    return sum;
}

TEST(VisibleParts, WallsPartAFloor) {
    for (const std::uint32_t flags : {0u, std::uint32_t(C_DETAIL)}) {
        const auto parts = FloorParts(BoxPlanes({3, -128, 0}, {7, 128, 128}), flags);
        ASSERT_EQ(parts.size(), 2u);
        EXPECT_DOUBLE_EQ(AreaOf(parts), (256 - 4) * 256);
        for (const Polygon &part : parts) {
            const Boundsf box = WindingBounds(part);
            EXPECT_TRUE(box.maxs.x == 3 || box.mins.x == 7) << box.mins.x << ' ' << box.maxs.x;
            EXPECT_EQ(PlaneOf(part).normal, Vec3d(0, 0, 1));
        }
    }
}

TEST(VisibleParts, DiagonalWallsDoToo) {
    std::vector<Plane> wall = BoxPlanes({-128, -128, 0}, {128, 128, 128});
    const double s = std::sqrt(0.5);
    wall.push_back({{s, s, 0}, 4});
    wall.push_back({{-s, -s, 0}, 4});
    for (const std::uint32_t flags : {0u, std::uint32_t(C_DETAIL)}) {
        const auto parts = FloorParts(wall, flags);
        ASSERT_EQ(parts.size(), 2u);
        const double leg = 256 - 4 / s;
        EXPECT_NEAR(AreaOf(parts), leg * leg, 1);
    }
}

TEST(VisibleParts, WhatCanBeWalkedAroundPartsNothing) {
    for (const std::uint32_t flags : {0u, std::uint32_t(C_DETAIL)}) {
        EXPECT_TRUE(FloorParts(BoxPlanes({3, -128, 0}, {7, 64, 128}), flags).empty()) << "a door";
        EXPECT_TRUE(FloorParts(BoxPlanes({-8, -8, 0}, {8, 8, 128}), flags).empty()) << "a pillar";
        EXPECT_TRUE(FloorParts(BoxPlanes({3, -128, 2}, {7, 128, 128}), flags).empty()) << "a gap below";
    }
    EXPECT_TRUE(FloorParts(BoxPlanes({3, -128, 0}, {7, 128, 128}), C_DETAIL | C_TRANSLUCENT).empty()) << "glass";
    EXPECT_TRUE(FloorParts(BoxPlanes({3, -128, 0}, {7, 128, 128}), C_DETAIL | C_NODRAW).empty()) << "nothing to see";
}

TEST(VisibleHull, OfASubModelIsTheWholeSide) {
    World world;
    const int box = world.AddBox({0, 0, 0}, {64, 64, 64});
    MapEntity &entity = world.map.World();
    ClipSidesIntoTree(entity, SingleLeafTree({}), world.map.planes, world.Context());
    for (std::size_t side = 0; side < 6; side++) {
        const BrushSide &of = world.Brushes()[std::size_t(world.IndexOf(box))].sides[side];
        EXPECT_EQ(of.visibleHull, of.winding);
    }
}

TEST(StructuralFaces, ThinBrushesBecomeDetailWithAWarning) {
    World world;
    const int box = world.AddBox({0, 0, 0}, {64, 64, 64});
    Brush &brush = world.Brushes()[std::size_t(world.IndexOf(box))];
    for (const std::size_t side : {0, 1, 2})
        brush.sides[side].winding.clear();
    EXPECT_TRUE(StructuralFaces(world.map.World(), world.Context()).empty());
    EXPECT_TRUE(brush.detail);
    EXPECT_THAT(world.text, HasSubstr("Entity 0, Brush 0: structural brush with 3 usable sides becomes detail"));
}

TEST(StructuralFaces, NewestComesFirstWithEvenPlanes) {
    World world;
    world.AddBox({0, 0, 0}, {64, 64, 64});
    const auto faces = StructuralFaces(world.map.World(), world.Context());
    ASSERT_EQ(faces.size(), 6u);
    const Brush &brush = world.Brushes()[0];
    for (std::size_t i = 0; i < 6; i++) {
        EXPECT_EQ(faces[i].polygon, brush.sides[5 - i].winding);
        EXPECT_EQ(faces[i].planeNum, brush.sides[5 - i].planeNum & ~1);
    }
}

TEST(StructuralFaces, PrioritiesAddUp) {
    World world;
    world.options.deep = true;
    world.AddBox({0, 0, 0}, {64, 64, 64}, C_HINT | C_DETAIL);
    for (const TreeFace &face : StructuralFaces(world.map.World(), world.Context()))
        EXPECT_EQ(face.priority, 1000 - 3000);
    world.options.deep = false;
    EXPECT_TRUE(StructuralFaces(world.map.World(), world.Context()).empty());
}

TEST(StructuralFaces, MapsOfStructuralBrushesAreWarnedOf) {
    World world;
    for (int i = 0; i < 501; i++)
        world.AddBox({i * 4.0, 0, 0}, {i * 4.0 + 4, 8, 8});
    (void)StructuralFaces(world.map.World(), world.Context());
    EXPECT_THAT(world.text, HasSubstr("501 of 501 brushes of the world are structural"));
}

} // namespace
} // namespace q3
