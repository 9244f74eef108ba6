// GPL-2.0-or-later. Patches: text, curves, groups, normals, meshes.
#include "libs/math/patch_mesh.h"
#include "q3map2/map/map_patch.h"
#include "tests/map/map_fixture.h"

#include <numbers>

namespace q3::test {

namespace {

/// Quarter of a tube of radius 64 along y, as a patch.
Patch QuarterTube() {
    Patch patch;
    patch.width = patch.height = 3;
    for (int row = 0; row < 3; ++row)
        for (const Vec3f &p : {Vec3f{0, 0, 64}, Vec3f{64, 0, 64}, Vec3f{64, 0, 0}}) {
            DrawVert v;
            v.xyz = p + Vec3f{0, float(row) * 32, 0};
            patch.verts.push_back(v);
        }
    return patch;
}

} // namespace

TEST_F(MapTest, PatchColumnsBecomeRows) {
    Map map = Read(WorldText(FlatPatchText(5, 3, {16, 32, 8})));
    const Patch &patch = map.World().patches.at(0);
    ASSERT_EQ(patch.width, 5);
    ASSERT_EQ(patch.height, 3);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 5; ++column) {
            const DrawVert &v = patch.verts[std::size_t(row * 5 + column)];
            EXPECT_EQ(v.xyz, (Vec3f{16 + 64 * float(column), 32 + 64 * float(row), 8}));
            EXPECT_EQ(v.st, (std::array{float(column), float(row)}));
            EXPECT_EQ(v.color, (std::array<std::uint8_t, 4>{255, 255, 255, 255}));
        }
    EXPECT_EQ(patch.shader->name, "textures/wall");
}

TEST_F(MapTest, NewPatchesComeFirst) {
    Map map = Read(WorldText(FlatPatchText(3, 3, {}) + FlatPatchText(3, 3, {})) +
                   EntityText("func_group", FlatPatchText(3, 3, {})));
    const std::deque<Patch> &patches = map.World().patches;
    ASSERT_EQ(patches.size(), 3u);
    EXPECT_EQ(patches[0].settings.entity, 1);
    EXPECT_EQ(patches[1].primitive, 1);
    EXPECT_EQ(patches[2].primitive, 0);
}

TEST_F(MapTest, PatchSizesMustBeOddFromThree) {
    for (const auto &[width, height] : {std::pair{4, 4}, {3, 2}, {1, 1}, {3, 4}, {0, 3}})
        EXPECT_TRUE(Read(WorldText(FlatPatchText(width, height, {}))).World().patches.empty()) << width;
    EXPECT_EQ(Warnings("patch size"), 5);
    EXPECT_THAT(ErrorOf(WorldText(FlatPatchText(33, 3, {}))),
                testing::AllOf(testing::HasSubstr("Entity 0, Brush 0"), testing::HasSubstr("33 x 3")));
    EXPECT_EQ(Read(WorldText(FlatPatchText(31, 31, {}))).World().patches.size(), 1u);
}

TEST_F(MapTest, PatchesInALineOrOutsideAreLeftOut) {
    EXPECT_TRUE(Read(WorldText(FlatPatchText(3, 3, {}, 0))).World().patches.empty());
    std::string line = "{ patchDef2 { wall ( 3 3 0 0 0 ) (";
    for (int column = 0; column < 3; ++column)
        line += fmt::format(" ( ( {0} {0} 0 0 0 ) ( {0} {0} 0 0 0 ) ( {0} {0} 0 0 0 ) )\n", column * 64);
    EXPECT_TRUE(Read(WorldText(line + ") } }\n")).World().patches.empty());
    EXPECT_EQ(Warnings("degenerate patch"), 2);
    EXPECT_TRUE(Read(WorldText(FlatPatchText(3, 3, {1e30, 0, 0}))).World().patches.empty());
    EXPECT_EQ(Warnings("patch outside"), 1);
}

TEST_F(MapTest, NewerPatchFormIsRead) {
    std::string text = FlatPatchText(3, 3, {});
    text.replace(text.find("patchDef2"), 9, "patchDef3");
    text.replace(text.find("wall"), 4, "\"textures/wall\"");
    text.replace(text.find("( 3 3 0 0 0 )"), 13, "( 3 3 8 8 0 0 0 )");
    Map map = Read(WorldText(text));
    ASSERT_EQ(map.World().patches.size(), 1u);
    EXPECT_EQ(map.World().patches[0].shader->name, "textures/wall");
}

TEST(FinishPatches, LongestCurveOfAQuarterCircle) {
    std::deque<Patch> patches{QuarterTube()};
    FinishPatches(patches);
    EXPECT_NEAR(patches[0].longestCurve, 143.196f, 0.001f);
}

TEST_F(MapTest, PatchesThatTouchChangeTheirDetailTogether) {
    // A chain of three whose ends touch within a unit, and one that is just too far.
    Map map = Read(WorldText(FlatPatchText(3, 3, {0, 0, 0}) + FlatPatchText(3, 3, {128.9, 0.9, 0.9}) +
                             FlatPatchText(3, 3, {257.8, 0, 0}) + FlatPatchText(3, 3, {0, 130.1, 0})));
    const std::deque<Patch> &patches = map.World().patches; // newest first
    ASSERT_EQ(patches.size(), 4u);
    for (const int i : {1, 2, 3}) {
        EXPECT_EQ(patches[std::size_t(i)].lodBounds.mins, (Vec3f{0, 0, 0}));
        EXPECT_NEAR(patches[std::size_t(i)].lodBounds.maxs.x, 385.8f, 1e-3f);
    }
    EXPECT_EQ(patches[0].lodBounds.maxs.x, 128);
}

TEST(SetPatchNormals, FlatPatchFacesColumnsTimesRows) {
    Patch patch;
    patch.width = 5, patch.height = 3;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 5; ++column) {
            DrawVert v;
            v.xyz = {float(column) * 32, float(row) * 32, 0};
            patch.verts.push_back(v);
        }
    SetPatchNormals(patch);
    for (const DrawVert &v : patch.verts)
        EXPECT_EQ(v.normal, (Vec3f{0, 0, 1}));
}

TEST(SetPatchNormals, ClosedTubeHasOneNormalAtItsSeam) {
    Patch patch;
    patch.width = 9, patch.height = 3;
    constexpr std::array<std::array<float, 2>, 9> ring{
        {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}, {1, 0}}};
    for (int row = 0; row < 3; ++row)
        for (const auto &p : ring) {
            DrawVert v;
            v.xyz = {p[0] * 64, p[1] * 64, float(row) * 32};
            patch.verts.push_back(v);
        }
    SetPatchNormals(patch);
    for (int row = 0; row < 3; ++row) {
        const Vec3f first = patch.verts[std::size_t(row * 9)].normal;
        EXPECT_GT(first.x, 0.999f) << "outwards";
        EXPECT_EQ(patch.verts[std::size_t(row * 9 + 8)].normal, first);
    }
}

TEST(TessellatePatch, MeshOfATubeIsOnTheCurve) {
    std::deque<Patch> patches{QuarterTube()};
    FinishPatches(patches);
    SetPatchNormals(patches[0]);
    // The parabola of the control points, at parameter u.
    const auto onParabola = [](const Vec3f &p) {
        double nearest = 1e9;
        for (int i = 0; i <= 4000; ++i) {
            const double u = i / 4000.0;
            const double x = 2 * u * (1 - u) * 64 + u * u * 64, z = (1 - u) * (1 - u) * 64 + 2 * u * (1 - u) * 64;
            nearest = std::min(nearest, std::hypot(double(p.x) - x, double(p.z) - z));
        }
        return nearest < 0.05;
    };
    for (const int subdivisions : {2, 4, 8}) {
        const PatchMesh mesh = TessellatePatch(patches[0], subdivisions);
        EXPECT_EQ(mesh.height, 2) << "straight along y";
        for (const DrawVert &v : mesh.verts)
            EXPECT_TRUE(onParabola(v.xyz));
        const std::vector<std::array<int, 3>> triangles = MeshTriangles(mesh);
        EXPECT_EQ(triangles.size(), std::size_t((mesh.width - 1) * 2));
    }
    EXPECT_GT(TessellatePatch(patches[0], 2).width, TessellatePatch(patches[0], 8).width);
}

TEST(Tessellated, NoAxisOfTheMeshReaches128Points) {
    for (const int size : {15, 17, 19, 31}) {
        // A wave, so that no column is flat.
        MeshOf<DrawVert> mesh{size, 3, {}};
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < size; ++column) {
                DrawVert v;
                v.xyz = {float(64 * column), float(64 * row), float(64 * (column % 2))};
                mesh.verts.push_back(v);
            }
        const float longest = 8 * 16 * 5; // of three halvings
        const int fine = 8 * (size - 1) + 1;
        EXPECT_EQ(Tessellated(mesh, longest).width, std::min(fine, 127)) << size;
    }
}

TEST(TessellatePatch, TrianglesCoverAFlatPatchOnceFacingUp) {
    Patch patch;
    patch.width = 5, patch.height = 5;
    for (int row = 0; row < 5; ++row)
        for (int column = 0; column < 5; ++column) {
            DrawVert v;
            v.xyz = {float(column) * 32, float(row) * 32, row == 2 && column == 2 ? 40.0f : 0.0f};
            v.color[3] = std::uint8_t(column * 40);
            patch.verts.push_back(v);
        }
    patch.longestCurve = 300;
    const PatchMesh mesh = TessellatePatch(patch, 8);
    double area = 0;
    for (const std::array<int, 3> &triangle : MeshTriangles(mesh)) {
        Polygon w;
        for (const int i : triangle)
            w.push_back(mesh.verts[std::size_t(i)].xyz);
        EXPECT_GT(PlaneOf(w).normal.z, 0.2);
        for (Vec3f &p : w)
            p.z = 0;
        area += WindingArea(w);
    }
    EXPECT_NEAR(area, 128 * 128, 1);
    for (int x = 1; x < mesh.width; ++x)
        EXPECT_GE(mesh.verts[std::size_t(x)].color[3], mesh.verts[std::size_t(x - 1)].color[3]);
    EXPECT_EQ(mesh.verts[std::size_t(mesh.width - 1)].color[3], 160);
}

TEST(Halvings, FollowCurveAndTolerance) {
    EXPECT_EQ(patch::Halvings(128), 0);
    EXPECT_EQ(patch::Halvings(129), 1);
    EXPECT_EQ(patch::Halvings(257), 2);
    EXPECT_EQ(patch::Halvings(1e6f), 3);
    EXPECT_EQ(patch::Halvings(129, 16), 0);
    EXPECT_EQ(patch::Halvings(129, 1), 3);
}

TEST_F(MapTest, PatchKeysComeFromTheEntityOrForGroupsTheWorld) {
    const std::string patch = FlatPatchText(3, 3, {});
    Map map = Read(EntityText("worldspawn", "\"_patchQuality\" \"4\"\n" + patch) + EntityText("func_group", patch) +
                   EntityText("func_group", "\"patchMeta\" \"1\"\n\"_patchSubdivide\" \"2\"\n" + patch) +
                   EntityText("func_static", patch));
    const std::deque<Patch> &world = map.World().patches; // last group first
    EXPECT_TRUE(world[0].patchMeta);
    EXPECT_EQ(world[0].patchSubdivisions, 1) << "2 over the quality of the world, at least 1";
    EXPECT_EQ(world[1].patchSubdivisions, 2) << "8 over 4";
    EXPECT_FALSE(world[2].patchMeta);
    EXPECT_EQ(world[2].patchSubdivisions, 2);
    EXPECT_EQ(map.entities.at(1).patches[0].patchSubdivisions, 0);
}

} // namespace q3::test
