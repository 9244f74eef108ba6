// GPL-2.0-or-later. Raw lightmaps: who shares one, its size and its projection.
#include "q3map2/light/sources/light_surfaces.h"
#include "tests/support/surface_case.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace q3::test {

namespace {

using testing::ElementsAre;

class SetupTest : public testing::Test {
  protected:
    GameFolder folder;
};

/// A closed tube around the z axis, seen from inside or outside.
void AddTube(SceneBuilder &scene, float radius, float height, std::string_view shader) {
    constexpr std::array<std::array<float, 2>, 9> kRing{
        {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}, {1, 0}}};
    std::vector<Vec3f> points;
    for (int row = 0; row < 3; ++row)
        for (const auto &p : kRing)
            points.push_back({p[0] * radius, p[1] * radius, height * float(row) / 2});
    scene.AddPatch(9, 3, points, Shaded(shader));
}

TEST_F(SetupTest, PlanarSurfacesStartAtTheirOwnCorner) {
    SceneBuilder scene = EmptyRoom();
    scene.AddQuad(Rectangle(5, -37, 5 + 256, -37 + 100, 3), Shaded(kA));
    SurfaceCase c(scene, folder);
    const SurfaceLight surfaces = c.Setup();
    const RawLightmap &raw = LightmapOf(c, surfaces, kA);
    // 0..272 and -48..64 in steps of 16, both ends included.
    EXPECT_EQ(raw.width, 18);
    EXPECT_EQ(raw.height, 8);
    EXPECT_TRUE(raw.planar);
    ExpectVector(raw.origin, {5, -37, 3});
    ExpectVector(raw.storedOrigin, {5, -37, 3});
    ExpectVector(raw.step[0], {16, 0, 0});
    ExpectVector(raw.step[1], {0, 16, 0});
    const bspDrawSurface_t &surface = c.bsp.drawSurfaces[std::size_t(raw.surfaces[0])];
    for (int k = 0; k < surface.numVerts; ++k) {
        const SurfaceVertex &v = surfaces.verts[std::size_t(surface.firstVert + k)];
        EXPECT_NEAR(v.luxel[0], (v.xyz.x - 5) / 16 + 0.5f, 1e-4);
        EXPECT_NEAR(v.luxel[1], (v.xyz.y + 37) / 16 + 0.5f, 1e-4);
    }
}

TEST_F(SetupTest, StepsLieInASlope) {
    SceneBuilder scene = EmptyRoom();
    // z = x / 2 - y / 4
    scene.AddQuad({{{0, 64, -16}, {128, 64, 48}, {128, 0, 64}, {0, 0, 0}}}, Shaded(kA));
    SurfaceCase c(scene, folder);
    const SurfaceLight surfaces = c.Setup();
    const RawLightmap &raw = LightmapOf(c, surfaces, kA);
    ExpectVector(raw.step[0], {16, 0, 8});
    ExpectVector(raw.step[1], {0, 16, -4});
    ExpectVector(raw.origin, {0, 0, 0});
}

TEST_F(SetupTest, OthersStartAtMultiplesOfTheSampleSize) {
    SceneBuilder scene = EmptyRoom();
    scene.AddTriangles(std::array<Vec3f, 4>{{{5, 7, 0}, {5, 90, 20}, {90, 90, 0}, {90, 7, 30}}},
                       std::array{0, 1, 2, 0, 2, 3}, Shaded(kA));
    Bsp bsp = scene.Build();
    for (bspDrawSurface_t &surface : bsp.drawSurfaces)
        if (surface.surfaceType == MST_TRIANGLE_SOUP)
            surface.surfaceType = MST_PLANAR;
    SurfaceCase c(bsp, folder);
    const SurfaceLight surfaces = c.Setup();
    const RawLightmap &raw = LightmapOf(c, surfaces, kA);
    EXPECT_FALSE(raw.planar);
    EXPECT_EQ(raw.origin.x, 0);
    EXPECT_EQ(raw.origin.y, 0);
    EXPECT_EQ(raw.width, 7);
    EXPECT_EQ(raw.height, 7);
}

TEST_F(SetupTest, TouchingSurfacesOfOnePlaneShareOne) {
    SceneBuilder scene = EmptyRoom();
    scene.AddQuad(Rectangle(0, 0, 64, 64, 0), Shaded(kA));
    scene.AddQuad(Rectangle(64, 0, 128, 64, 0), Shaded(kB));
    scene.AddQuad(Rectangle(0, 0, 64, 64, 1), Shaded("textures/test/higher"));
    scene.AddQuad(Rectangle(200, 0, 264, 64, 0), Shaded("textures/test/apart"));
    SurfaceCase c(scene, folder);
    const SurfaceLight surfaces = c.Setup();
    const int a = SurfacesOf(c, kA)[0], b = SurfacesOf(c, kB)[0];
    const RawLightmap &raw = LightmapOf(c, surfaces, kA);
    EXPECT_THAT(raw.surfaces, ElementsAre(a, b)) << "by shader name";
    EXPECT_EQ(raw.width, 9);
    EXPECT_EQ(raw.height, 5);
    EXPECT_EQ(LightmapOf(c, surfaces, "textures/test/higher").surfaces.size(), 1u);
    EXPECT_EQ(LightmapOf(c, surfaces, "textures/test/apart").surfaces.size(), 1u);
}

TEST_F(SetupTest, SurfaceFileKeepsUnlikeSurfacesApart) {
    for (const std::string_view key : {"entity 3", "receiveShadows 2", "sampleSize 8", "ambientColor ( 9 9 9 )"}) {
        SceneBuilder scene = EmptyRoom();
        scene.AddQuad(Rectangle(0, 0, 64, 64, 0), Shaded(kA));
        scene.AddQuad(Rectangle(64, 0, 128, 64, 0), Shaded(kB));
        const std::string axis = "lightmapAxis ( 0 0 1 )";
        CaseSettings settings;
        settings.surfaces =
            fmt::format("default\n{{\nsampleSize 16\n}}\n6\n{{\n{0}\n}}\n7\n{{\n{0}\n{1}\n}}\n", axis, key);
        SurfaceCase c(scene, folder, settings);
        ASSERT_EQ(SurfacesOf(c, kA)[0], 6);
        const SurfaceLight surfaces = c.Setup();
        EXPECT_NE(surfaces.lightmapOf[6], surfaces.lightmapOf[7]) << key;
        EXPECT_GE(surfaces.lightmapOf[7], 0);
    }
}

TEST_F(SetupTest, SurfaceFileSaysSampleSizeAndAmbient) {
    SceneBuilder scene = EmptyRoom();
    scene.SetWorldKey("_ambient", "7");
    scene.AddQuad(Rectangle(0, 0, 64, 64, 0), Shaded(kA));
    scene.AddQuad(Rectangle(0, 0, 64, 64, 32), Shaded(kB));
    CaseSettings settings;
    settings.lightmap.sampleSize = 4;
    settings.surfaces =
        "default\n{\nsampleSize 16\nambientColor ( 1 2 3 )\n}\n6\n{\nlightmapAxis ( 0 0 1 )\nsampleSize "
        "32 // rest\nambientColor ( 4 5 6 )\n}\n7\n{\nlightmapAxis ( 0 0 1 )\n}\n";
    SurfaceCase c(scene, folder, settings);
    const SurfaceLight surfaces = c.Setup();
    EXPECT_EQ(LightmapOf(c, surfaces, kA).sampleSize, 32);
    ExpectVector(LightmapOf(c, surfaces, kA).ambient, {4, 5, 6});
    EXPECT_EQ(LightmapOf(c, surfaces, kB).sampleSize, 16);
    ExpectVector(LightmapOf(c, surfaces, kB).ambient, {1, 2, 3});
}

TEST_F(SetupTest, WithoutSurfaceFileShadersAndEntitiesSaySampleSizes) {
    SceneBuilder scene = EmptyRoom();
    scene.SetWorldKey("_lightmapscale", "0.5");
    scene.SetWorldKey("_ambient", "7");
    scene.AddQuad(Rectangle(0, 0, 64, 64, 0), Shaded(kA));
    scene.AddQuad(Rectangle(0, 0, 64, 64, 32), Shaded(kB));
    scene.AddInlineModel({0, 0, 128}, {64, 64, 192}, Shaded("textures/test/door"),
                         {{{"classname", "func_door"}, {"_samplesize", "6"}, {"_rs", "4"}}});
    CaseSettings settings;
    settings.lightmap.sampleSize = 40;
    settings.lightmap.minSampleSize = 5;
    settings.script = "textures/test/b\n{\nq3map_lightmapSampleSize 4\n}\n";
    SurfaceCase c(scene, folder, settings);
    EXPECT_EQ(c.table[std::size_t(SurfacesOf(c, kA)[0])].sampleSize, 20);
    EXPECT_EQ(c.table[std::size_t(SurfacesOf(c, kB)[0])].sampleSize, 5) << "4 * 0.5, but at least -minsamplesize";
    const std::vector<int> door = SurfacesOf(c, "textures/test/door");
    ASSERT_FALSE(door.empty());
    for (const int number : door) {
        const SurfaceEntry &entry = c.table[std::size_t(number)];
        EXPECT_EQ(entry.sampleSize, 6);
        EXPECT_EQ(entry.receiveShadows, 4);
        EXPECT_EQ(entry.castShadows, 0);
        EXPECT_NE(entry.entity, 0);
        EXPECT_EQ(entry.ambient.x, 7);
    }
}

TEST_F(SetupTest, MergableTerrainIsOneLightmap) {
    for (const bool mergable : {false, true}) {
        SceneBuilder scene = EmptyRoom();
        // Two planes that meet in a ridge.
        scene.AddQuad({{{0, 64, 0}, {64, 64, 32}, {64, 0, 32}, {0, 0, 0}}}, Shaded(kA));
        scene.AddQuad({{{64, 64, 32}, {128, 64, 0}, {128, 0, 0}, {64, 0, 32}}}, Shaded(kA));
        CaseSettings settings;
        settings.script = fmt::format("{}\n{{\n{}\n}}\n", kA, mergable ? "q3map_lightmapMergable" : "");
        SurfaceCase c(scene, folder, settings);
        const SurfaceLight surfaces = c.Setup();
        const std::vector<int> both = SurfacesOf(c, kA);
        ASSERT_EQ(both.size(), 2u);
        const int first = surfaces.lightmapOf[std::size_t(both[0])], second = surfaces.lightmapOf[std::size_t(both[1])];
        EXPECT_EQ(first == second, mergable);
        EXPECT_EQ(surfaces.lightmaps[std::size_t(first)].planar, !mergable) << "one plane does not hold both";
    }
}

TEST_F(SetupTest, LongSurfacesGetTheSmallestSampleSizeThatFits) {
    SceneBuilder scene = EmptyRoom({-4096, -64, -64}, {4096, 64, 64});
    scene.AddQuad(Rectangle(-3000, -32, 3001, 32, 0), Shaded(kA));
    SurfaceCase c(scene, folder);
    const SurfaceLight surfaces = c.Setup();
    const RawLightmap &raw = LightmapOf(c, surfaces, kA);
    const auto luxels = [](double s) { return std::ceil(3001 / s) - std::floor(-3000 / s) + 1; };
    double size = 16;
    while (luxels(size) > 128)
        ++size;
    EXPECT_EQ(raw.actualSampleSize, size);
    EXPECT_EQ(raw.width, luxels(size));
    EXPECT_EQ(raw.sampleSize, 16);
}

TEST_F(SetupTest, PagesAndLimitsBoundTheSize) {
    SceneBuilder scene = EmptyRoom();
    scene.AddQuad(Rectangle(0, 0, 640, 640, 0), Shaded(kA));
    scene.AddQuad(Rectangle(0, 0, 640, 640, 64), Shaded(kB));
    CaseSettings settings;
    settings.script = "textures/test/b\n{\nq3map_lightmapSize 32 32\n}\n";
    SurfaceCase plain(scene, folder, settings);
    const SurfaceLight free = plain.Setup();
    EXPECT_EQ(LightmapOf(plain, free, kA).width, 41);
    EXPECT_EQ(LightmapOf(plain, free, kB).width, 32) << "640 / 21 < 31 steps";
    EXPECT_EQ(LightmapOf(plain, free, kB).actualSampleSize, 21);
    settings.lightmap.rawSizeLimit = 11;
    SurfaceCase limited(scene, folder, settings);
    EXPECT_EQ(LightmapOf(limited, limited.Setup(), kA).actualSampleSize, 64);
    settings.lightmap.rawSizeLimit = 0;
    settings.lightmap.sampleScale = 2;
    SurfaceCase scaled(scene, folder, settings);
    EXPECT_EQ(LightmapOf(scaled, scaled.Setup(), kA).width, 21);
}

TEST_F(SetupTest, ALightmapTooSmallForItsSurfaceIsNone) {
    SceneBuilder scene = EmptyRoom();
    scene.AddQuad(Rectangle(-8, -8, 8, 8, 0), Shaded(kA));
    CaseSettings settings;
    settings.lightmap.rawSizeLimit = 2; // three luxels stand around 0
    SurfaceCase c(scene, folder, settings);
    EXPECT_EQ(c.Setup().lightmapOf[std::size_t(SurfacesOf(c, kA)[0])], -1);
    EXPECT_THAT(c.quiet.text, testing::HasSubstr("lit at its vertices"));
}

TEST_F(SetupTest, ATubeFollowsItsOwnParameters) {
    SceneBuilder scene = EmptyRoom();
    AddTube(scene, 200, 320, kA);
    SurfaceCase c(scene, folder);
    const SurfaceLight surfaces = c.Setup();
    const RawLightmap &raw = LightmapOf(c, surfaces, kA);
    EXPECT_FALSE(raw.hasVectors);
    EXPECT_FALSE(raw.planar);
    EXPECT_TRUE(raw.wrapS);
    EXPECT_FALSE(raw.wrapT);
    // Parabolas through the quarters of the ring, cut into chords: a little off the circle.
    EXPECT_NEAR(raw.width, 2 * std::numbers::pi * 200 / 16 + 1, 4);
    EXPECT_EQ(raw.height, 320 / 16 + 1);
    const bspDrawSurface_t &surface = c.bsp.drawSurfaces[std::size_t(raw.surfaces[0])];
    const SurfaceVertex &last = surfaces.verts[std::size_t(surface.firstVert + surface.numVerts - 1)];
    EXPECT_FLOAT_EQ(last.luxel[0], float(raw.width) - 0.5f);
    EXPECT_FLOAT_EQ(last.luxel[1], float(raw.height) - 0.5f);
    EXPECT_EQ(raw.storedOrigin, Vec3f{});
}

TEST_F(SetupTest, GentlePatchesAreProjected) {
    SceneBuilder scene = EmptyRoom();
    std::vector<Vec3f> points;
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 3; ++x)
            points.push_back({float(x) * 64, float(y) * 64, x == 1 ? 32.0f : 0.0f});
    scene.AddPatch(3, 3, points, Shaded(kA));
    SurfaceCase c(scene, folder);
    const SurfaceLight surfaces = c.Setup();
    const RawLightmap &raw = LightmapOf(c, surfaces, kA);
    EXPECT_TRUE(raw.hasVectors);
    EXPECT_FALSE(raw.planar);
    EXPECT_EQ(std::abs(raw.axis.z), 1);
    EXPECT_EQ(raw.width, 9);
    EXPECT_EQ(raw.height, 9);
}

TEST_F(SetupTest, VertexLitSurfacesHaveNone) {
    SceneBuilder scene = EmptyRoom();
    scene.AddQuad(Rectangle(0, 0, 64, 64, 0), Shaded(kA));
    scene.AddTriangles(std::array<Vec3f, 3>{{{0, 0, 64}, {0, 64, 64}, {64, 64, 64}}}, std::array{0, 1, 2}, Shaded(kB));
    CaseSettings settings;
    settings.script = "textures/test/a\n{\nsurfaceparm nolightmap\n}\n";
    SurfaceCase c(scene, folder, settings);
    const SurfaceLight surfaces = c.Setup();
    EXPECT_EQ(surfaces.lightmapOf[std::size_t(SurfacesOf(c, kA)[0])], -1);
    EXPECT_EQ(surfaces.lightmapOf[std::size_t(SurfacesOf(c, kB)[0])], -1);
    EXPECT_EQ(surfaces.lightmaps.size(), 6u) << "the walls";
    settings.lightmap.noLightmaps = true;
    SurfaceCase none(scene, folder, settings);
    EXPECT_TRUE(none.Setup().lightmaps.empty());
}

TEST_F(SetupTest, SamplesAreCenteredOnTheirLuxel) {
    for (const int super : {1, 2, 3, 4, 8}) {
        SceneBuilder scene = EmptyRoom();
        scene.AddQuad({{{8, 64, 8}, {128, 64, 68}, {128, 0, 68}, {8, 0, 8}}}, Shaded(kA));
        CaseSettings settings;
        settings.lightmap.super = super;
        SurfaceCase c(scene, folder, settings);
        const SurfaceLight surfaces = c.Setup();
        const RawLightmap &raw = LightmapOf(c, surfaces, kA);
        Vec3f sum;
        for (int y = 0; y < super; ++y)
            for (int x = 0; x < super; ++x)
                sum += raw.origin + raw.step[0] * float(x) + raw.step[1] * float(y);
        ExpectVector(sum / float(super * super), raw.storedOrigin, 1e-2f);
        ExpectVector(raw.step[0] * float(super), {16, 0, 8}, 1e-3f);
        EXPECT_EQ(raw.SuperWidth(), 9 * super);
    }
}

TEST_F(SetupTest, ACurveLeftForCollisionTakesNoLightmapAndDoesNotShine) {
    constexpr std::uint32_t kNoDraw = 0x80;
    for (const std::uint32_t flags : {0u, kNoDraw}) {
        std::vector<Vec3f> points;
        for (int i = 0; i < 9; ++i)
            points.push_back({64 * float(i % 3), 64 * float(i / 3), i == 4 ? 32.f : 0.f});
        SceneBuilder scene = EmptyRoom();
        scene.AddPatch(3, 3, points, {std::string(kA), flags, 1});
        CaseSettings settings{.script = "textures/test/a\n{\n\tq3map_surfacelight 1000\n}\n"};
        settings.light.noDrawSurfaceFlags = kNoDraw;
        SurfaceCase c(scene, folder, settings);
        const SurfaceLight surfaces = c.Setup();
        SurfaceLightCounts counts;
        const BspSpace space(c.bsp, std::vector<bool>(c.bsp.brushes.size()));
        const std::vector<Light> lights =
            SurfaceLights(space, c.table, c.settings.light, c.world, c.library, counts, c.quiet.log);
        const std::vector<int> numbers = SurfacesOf(c, kA);
        ASSERT_EQ(numbers.size(), 1u);
        EXPECT_EQ(surfaces.lightmapOf[std::size_t(numbers[0])] >= 0, flags == 0);
        EXPECT_EQ(!lights.empty(), flags == 0);
    }
}

TEST_F(SetupTest, ClustersAreThoseOfTheLeafsAround) {
    SceneBuilder scene = EmptyRoom({0, 0, 0}, {256, 128, 128});
    scene.AddBox({120, 0, 0}, {136, 128, 128}, Shaded("textures/test/wall"));
    scene.AddQuad(Rectangle(16, 16, 100, 100, 0.5f), Shaded(kA));
    SurfaceCase c(scene, folder);
    const RawLightmap raw = LightmapOf(c, c.Setup(), kA);
    EXPECT_THAT(raw.clusters, ElementsAre(c.space.ClusterAt({60, 60, 10}, 0)));
}

TEST_F(SetupTest, InlineModelsStandAtTheirOrigin) {
    SceneBuilder scene = EmptyRoom();
    scene.AddInlineModel({0, 0, 0}, {64, 64, 64}, Shaded("textures/test/door"),
                         {{{"classname", "func_door"}, {"origin", "100 200 300"}}});
    SurfaceCase c(scene, folder);
    const SurfaceLight surfaces = c.Setup();
    for (const int number : SurfacesOf(c, "textures/test/door")) {
        const Boundsf &bounds = surfaces.bounds[std::size_t(number)];
        EXPECT_GE(bounds.mins.x, 100);
        EXPECT_LE(bounds.maxs.z, 364);
        EXPECT_GE(bounds.mins.z, 300);
    }
}

} // namespace

} // namespace q3::test
