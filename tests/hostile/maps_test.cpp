// GPL-2.0-or-later. Maps that are hardly maps: empty, solid, thin, huge, broken.
#include "tests/hostile/stress_fixture.h"

#include <limits>

namespace q3::test {

namespace {

using MapsTest = StressTest;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

Bsp WithoutSurfaces(Bsp bsp) {
    bsp.drawSurfaces.clear(), bsp.drawVerts.clear(), bsp.drawIndexes.clear(), bsp.leafSurfaces.clear();
    for (bspModel_t &model : bsp.models)
        model.firstBSPSurface = model.numBSPSurfaces = 0;
    for (bspLeaf_t &leaf : bsp.leafs)
        leaf.firstBSPLeafSurface = leaf.numBSPLeafSurfaces = 0;
    return bsp;
}

Bsp WithoutBrushes(Bsp bsp) {
    bsp.brushes.clear(), bsp.brushSides.clear(), bsp.leafBrushes.clear();
    for (bspModel_t &model : bsp.models)
        model.firstBSPBrush = model.numBSPBrushes = 0;
    for (bspLeaf_t &leaf : bsp.leafs)
        leaf.firstBSPLeafBrush = leaf.numBSPLeafBrushes = 0;
    return bsp;
}

SceneBuilder LitRoom() {
    SceneBuilder scene = Room();
    scene.AddEntity(PointLight("10 20 100"));
    return scene;
}

bool FromTheLight(const Vec3d &p, Coefficients &c) {
    c = FromPoint(p, {10, 20, 100}, 300);
    return Inside(p, RoomBounds());
}

TEST_F(MapsTest, WithoutSurfacesOrBrushesTheTreeIsEnough) {
    const Bsp room = LitRoom().Build();
    for (const Bsp &bsp : {WithoutSurfaces(room), WithoutBrushes(room), WithoutSurfaces(WithoutBrushes(room))})
        ExpectPoints(GridView(LitSoundly(bsp, kBothGrids)), kExact, 60, FromTheLight);
}

TEST_F(MapsTest, WithoutATreeAllIsOneLeaf) {
    for (const int cluster : {0, -1}) {
        Bsp bsp = WithoutSurfaces(WithoutBrushes(LitRoom().Build()));
        bsp.nodes.clear(), bsp.planes.clear();
        bsp.leafs.resize(1);
        bsp.leafs[0].cluster = cluster;
        bsp.leafs[0].mins = {-256, -256, -16}, bsp.leafs[0].maxs = {256, 256, 272};
        const GridView grid(LitSoundly(bsp, kBothGrids));
        if (cluster < 0)
            for (std::size_t i = 0; i < grid.Count(); i++)
                ASSERT_EQ(Largest(grid.At(i)), 0);
        else
            ExpectPoints(grid, kExact, 60, FromTheLight);
    }
}

TEST_F(MapsTest, WithoutLightOnlyAmbientIsLeft) {
    SceneBuilder scene = Room();
    scene.SetWorldKey("_ambient", "51");
    const GridView grid(LitSoundly(scene, kBothGrids));
    EXPECT_EQ(result.gridSH.counts.rays, 0u);
    ExpectPoints(grid, kExact, 60, [](const Vec3d &p, Coefficients &c) {
        c = FromEverywhere({0.2, 0.2, 0.2});
        return Inside(p, RoomBounds());
    });
    const Bsp unlit = LitSoundly(Room(), kBothGrids);
    const GridView dark(unlit);
    for (std::size_t i = 0; i < dark.Count(); i++)
        ASSERT_EQ(Largest(dark.At(i)), 0);
    EXPECT_FALSE(unlit.sparseGridSH->points.empty());
    for (const SparseGridPoint &point : unlit.sparseGridSH->points)
        ASSERT_EQ(point, SparseGridPoint{});
}

TEST_F(MapsTest, WithoutAnyRoomInTheOpenNothingIsTraced) {
    Bsp bsp = LitRoom().Build();
    for (bspLeaf_t &leaf : bsp.leafs)
        leaf.cluster = -1;
    LitSoundly(bsp, kBothGrids);
    EXPECT_EQ(result.gridSH.counts.rays, 0u);
    EXPECT_EQ(result.gridSH.open, 0);
}

TEST_F(MapsTest, OneCellThickOnEachAxis) {
    for (std::size_t axis = 0; axis < 3; axis++) {
        SCOPED_TRACE(axis);
        // 16 units of wall on both sides; the only multiple of 64 is 0, in the middle of the space.
        Vec3f mins{-250, -250, -250}, maxs{250, 250, 250};
        mins[axis] = -20, maxs[axis] = 20;
        SceneBuilder scene = Room(mins, maxs);
        scene.AddEntity(PointLight("1 2 3"));
        const Boundsf room{mins, maxs};
        const Bsp lit = LitSoundly(scene, "-gridsh 64 64 64 -shbudget 0.1");
        const GridView grid(lit);
        EXPECT_EQ(grid.Grid().header.gridBounds[axis], 1);
        ExpectPoints(grid, kExact, 40, [&](const Vec3d &p, Coefficients &c) {
            c = FromPoint(p, {1, 2, 3}, 300);
            return Inside(p, room);
        });
        // Cells of the sparse grid are smaller than the space is thick.
        const SparseView sparse(*lit.sparseGridSH);
        for (const double off : {-19.0, -7.0, 0.0, 19.0}) {
            Vec3d p{90, -110, 130};
            p[axis] = off;
            const Coefficients wanted = FromPoint(p, {1, 2, 3}, 300);
            EXPECT_LE(Difference(sparse.Sample(p), wanted), 0.1 * Largest(wanted)) << off;
        }
    }
}

TEST_F(MapsTest, TinyCellsOnAHugeWorldGrow) {
    Bsp bsp;
    bsp.models.resize(1);
    std::string text;
    Log log([&](LogLevel, std::string_view line) { text += line; }, true);
    for (const float half : {4096.0f, 65536.0f, 1e6f}) {
        bsp.models[0].mins = {-half, -half, -half}, bsp.models[0].maxs = {half, half, half};
        Entity world{{{"classname", "worldspawn"}, {"gridsize", "8 8 8"}}};
        const GridLayout legacy = SetupGrid(bsp, world, log);
        EXPECT_LE(legacy.Count(), 0x100000);
        LightOptions options;
        options.gridSizeSH = Vec3f{8, 8, 8};
        text.clear();
        const GridLayout sh = SetupGridSH(bsp, legacy.size, options, log);
        EXPECT_LE(sh.Count() * 108 + 40, 0x7fffffff);
        EXPECT_GE(sh.Count(), 0x1000000 / 4) << "grown too far";
        EXPECT_EQ(text.find("WARNING") != std::string::npos, sh.size[0] > 8) << text;
    }
    // Not even countable.
    bsp.models[0].mins = {-1e30f, -1e30f, -1e30f}, bsp.models[0].maxs = {1e30f, 1e30f, 1e30f};
    Entity world{{{"classname", "worldspawn"}}};
    EXPECT_THROW(SetupGrid(bsp, world, log), Error);
}

/// Sets every `step`-th vertex of surfaces that are no lights' to a value that is no place.
Bsp Broken(Bsp bsp, std::size_t step, float value) {
    for (std::size_t i = 0; i < bsp.drawVerts.size(); i += step) {
        bsp.drawVerts[i].xyz[i % 3] = value;
        bsp.drawVerts[i].normal[(i + 1) % 3] = value;
        bsp.drawVerts[i].st[i % 2] = value;
    }
    return bsp;
}

TEST_F(MapsTest, VerticesThatAreNoNumbers) {
    LampShader("textures/test/lamp", 300);
    SceneBuilder scene = LitRoom();
    scene.AddQuad({{{-64, -32, 236}, {64, -32, 236}, {64, 32, 236}, {-64, 32, 236}}}, TestShader("textures/test/lamp"));
    scene.AddQuad({{{-64, 32, 136}, {-64, -32, 136}, {64, -32, 136}, {64, 32, 136}}}, TestShader("textures/test/wall"));
    scene.SetWallShader(BoxFace::MinusY, TestShader("textures/vec/sky_ext"));
    std::vector<Vec3f> patch;
    for (int i = 0; i < 9; i++)
        patch.push_back({float(i % 3) * 32, float(i / 3) * 32, float(i % 2) * 16 + 60});
    scene.AddPatch(3, 3, patch, TestShader("textures/test/lamp"));
    const Bsp whole = scene.Build();
    for (const float value : {kNan, kInf, -kInf, 3e38f, 1e30f, 1e15f, 1e-40f})
        for (const std::size_t step : {std::size_t(1), std::size_t(5), std::size_t(13)})
            for (const char *options : {"-gridsh 64 64 64 -shadaptive", "-gridsh 64 64 64 -patchshadows -noskip"}) {
                SCOPED_TRACE(fmt::format("{} {} {}", value, step, options));
                LitSoundly(Broken(whole, step, value), options);
            }
}

TEST_F(MapsTest, PlanesWithoutNormal) {
    const Bsp whole = LitRoom().Build();
    for (std::size_t i = 0; i < whole.planes.size(); i++)
        for (const float dist : {0.0f, 100.0f, -100.0f, 1e30f}) {
            Bsp bsp = whole;
            bsp.planes[i].normal = {0, 0, 0};
            bsp.planes[i].dist = dist;
            LitSoundly(bsp, "-gridsh 128 128 128");
        }
    for (const float length : {1e-30f, 1e-3f, 1e3f, 1e30f}) {
        Bsp bsp = whole;
        for (bspPlane_t &plane : bsp.planes)
            for (float &component : plane.normal)
                component *= length;
        LitSoundly(bsp, "-gridsh 128 128 128 -shadaptive");
    }
}

TEST_F(MapsTest, TreesOfOnePlaneOverAndOver) {
    // Every node splits by the same plane: half of the leafs are never reached.
    Bsp bsp = LitRoom().Build();
    for (bspNode_t &node : bsp.nodes)
        node.planeNum = bsp.nodes.front().planeNum;
    LitSoundly(bsp, kBothGrids);
}

} // namespace

} // namespace q3::test
