// GPL-2.0-or-later. The comparison of lit files: differences made on purpose are found where they are.
#include "tools/measure/lightmap_compare/compare.h"

#include "common/error.h"
#include "q3map2/lightmap/store/lightmap_pages.h"
#include "q3map2/lightmap/store/lightmap_scripts.h"
#include "tests/support/store_fixture.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace q3::test {

namespace {

using compare::Compare;
using compare::Comparison;
using compare::LitMap;

class CompareTest : public StoreTest {
  protected:
    /// Smooth light, another on each surface; `change` alters it.
    void Light(int width, const std::function<void(std::size_t surface, int x, int y, Vec3f &color)> &change = {}) {
        MakeLightmaps(width, width);
        for (std::size_t i = 0; i < 6; ++i)
            Fill(surfaces.lightmaps[i], [&](int x, int y) {
                const float s = float(x) / float(width - 1), t = float(y) / float(width - 1);
                Vec3f color{40 + 100 * s, 40 + 100 * t, 20 + 20 * float(i)};
                if (change)
                    change(i, x, y, color);
                return color;
            });
        surfaces.vertex.sum[0].assign(bsp.drawVerts.size(), {10, 20, 30});
    }
    /// Lights, stores and writes everything as a map of that name, and reads it back.
    LitMap Written(const std::string &name) {
        Bsp unlit = bsp;
        StoredLightmaps stored = Finish(1, name);
        FinishForFile(lightmap, name, stored, bsp);
        const auto path = folder / ("maps/" + name + ".bsp");
        std::filesystem::create_directories(path.parent_path());
        WriteBspFile(path, bsp, {}, log);
        FileSet written;
        AddPages(folder / ("maps/" + name), stored, written, log);
        AddScript(ScriptPath(path, *FindGame("quake3")), stored, written, log);
        written.Commit();
        bsp = std::move(unlit);
        return LitMap::Load(path, 128, log);
    }
};

TEST_F(CompareTest, AFileIsItself) {
    Light(30);
    const LitMap a = Written("a");
    const Comparison c = Compare(a, a, 100, 3);
    EXPECT_EQ(c.lightmapped.both, 6u);
    EXPECT_EQ(c.lightmaps.count, 600u);
    EXPECT_EQ(c.lightmaps.worst, 0);
    EXPECT_EQ(c.lightmaps.within8, 1);
    EXPECT_EQ(c.surfacesWithin2, 6u);
    EXPECT_EQ(c.lightmapVertices.count, bsp.drawVerts.size());
    EXPECT_EQ(c.worst.size(), 3u);
}

TEST_F(CompareTest, PackingAndPageSizeMakeNoDifference) {
    Light(30);
    const LitMap a = Written("a");
    lightmap.collapse = false;
    lightmap.external = true;
    lightmap.pageSize = {64, 32};
    Light(30);
    const LitMap b = Written("b");
    EXPECT_EQ(b.PageCount(), 3u);
    EXPECT_LT(Compare(a, b, 200, 0).lightmaps.worst, 1e-3);
    lightmap.external = false;
    lightmap.pageSize = {256, 256};
    Light(30);
    const LitMap made = Written("made");
    EXPECT_EQ(made.Map().drawSurfaces[0].lightmapNum[0], kLightmapByVertex);
    const Comparison c = Compare(a, made, 200, 0);
    EXPECT_EQ(c.lightmapped.both, 6u) << "found through the made shaders";
    EXPECT_LT(c.lightmaps.worst, 1e-3);
}

TEST_F(CompareTest, ResolutionMakesLittleDifferenceToSmoothLight) {
    Light(16);
    const LitMap coarse = Written("a");
    Light(61);
    const LitMap fine = Written("b");
    EXPECT_LT(Compare(coarse, fine, 500, 0).lightmaps.worst, 1.5) << "bytes are cut off";
}

TEST_F(CompareTest, DifferencesAreFoundOnTheirSurface) {
    Light(30);
    const LitMap a = Written("a");
    Light(30, [](std::size_t surface, int, int y, Vec3f &color) {
        if (surface == 3 && y >= 15)
            color.y += 50;
        if (surface == 4)
            color = color + Vec3f{3, 3, 3};
    });
    surfaces.vertex.sum[0].assign(bsp.drawVerts.size(), {10, 26, 30});
    const LitMap b = Written("b");
    const Comparison c = Compare(b, a, 1000, 2);
    ASSERT_EQ(c.worst.size(), 2u);
    EXPECT_EQ(c.worst[0].surface, 3u);
    EXPECT_EQ(c.worst[0].shader, a.ShaderOf(3));
    EXPECT_NEAR(c.worst[0].spread.mean, 50.0 / 3 / 2, 0.3) << "half of it, one of three channels";
    EXPECT_NEAR(c.worst[0].b.y + 25, c.worst[0].a.y, 1);
    EXPECT_EQ(c.worst[1].surface, 4u);
    EXPECT_NEAR(c.worst[1].spread.mean, 3, 1e-3);
    EXPECT_EQ(c.surfacesWithin2, 4u);
    EXPECT_NEAR(c.lightmaps.within8, 1 - 0.5 / 6, 0.005);
    EXPECT_NEAR(c.lightmaps.percentile95, 50, 0.1);
    EXPECT_NEAR(*c.lightmaps.bias, (50.0 / 6 + 3) / 6, 0.1) << "A is brighter";
    EXPECT_NEAR(c.lightmapVertices.mean, 2, 1e-9) << "6 in one of three channels";
    const nlohmann::json json = nlohmann::json::parse(ToJson(c));
    EXPECT_EQ(json["worst"][0]["surface"], 3);
    EXPECT_EQ(json["surfacesWithin2"], 4);
    EXPECT_THAT(ToText(c), testing::HasSubstr("4 of 6 surfaces within 2"));
}

TEST_F(CompareTest, BlackSamplesAreCountedApart) {
    Light(30);
    const LitMap a = Written("a");
    Light(30, [](std::size_t surface, int, int, Vec3f &color) {
        if (surface == 2)
            color = {};
    });
    const Comparison c = Compare(a, Written("b"), 100, 0);
    EXPECT_EQ(c.lit.onlyA, 100u);
    EXPECT_EQ(c.lit.both, 500u);
    EXPECT_LT(c.lightmaps.worst, 1e-9);
}

TEST_F(CompareTest, TexelsUnderABoxAreNotCompared) {
    // A detail box stands on the floor: no luxel is under it, so its texels are free for other lightmaps.
    SceneBuilder scene;
    scene.SetInterior({0, 0, 0}, {256, 256, 256}, {"textures/test/wall"});
    scene.AddBox({64, 64, 0}, {192, 192, 64}, {"textures/test/box"}, BoxKind::Detail);
    bsp = scene.Build();
    constexpr int kWidth = 33; // luxels of 8 units
    const auto light = [&](bool other) {
        MakeLightmaps(kWidth, kWidth);
        for (std::size_t i = 0; i < bsp.drawSurfaces.size(); ++i) {
            const bspDrawVert_t *v = &bsp.drawVerts[std::size_t(bsp.drawSurfaces[i].firstVert)];
            const Vec3f origin(v[0].xyz), across = Vec3f(v[1].xyz) - origin, down = Vec3f(v[3].xyz) - origin;
            const bool floor = origin.z == 0 && across.z == 0 && down.z == 0;
            Fill(surfaces.lightmaps[i], [&](int x, int y) {
                const Vec3f p = origin + across * (float(x) / (kWidth - 1)) + down * (float(y) / (kWidth - 1));
                const bool under = floor && std::min({p.x - 64, 192 - p.x, p.y - 64, 192 - p.y}) > 4.5f;
                return other && under ? Vec3f{250, 250, 250} : Vec3f{40, 50, 60};
            });
        }
        surfaces.vertex.sum[0].assign(bsp.drawVerts.size(), {10, 20, 30});
    };
    light(false);
    const LitMap a = Written("a");
    light(true);
    const Comparison c = Compare(a, Written("b"), 1000, 0);
    EXPECT_LT(c.lightmaps.worst, 1e-3);
    EXPECT_NEAR(double(c.buried + c.uncovered) / 1000, 0.25, 0.03) << "the box has a quarter of the floor";
    EXPECT_THAT(ToText(c), testing::HasSubstr("without a luxel"));
}

TEST_F(CompareTest, ByAreaASliverCountsAsLittleAsItIs) {
    Light(30);
    const auto lower = [&](std::size_t surface, float share) {
        const bspDrawSurface_t &s = bsp.drawSurfaces[surface];
        for (int v = s.firstVert; v < s.firstVert + s.numVerts; ++v)
            for (float &at : bsp.drawVerts[std::size_t(v)].xyz)
                at *= share;
    };
    for (std::size_t i = 0; i < 6; ++i)
        lower(i, i == 3 ? 0.1f : 1.0f);
    const LitMap a = Written("a");
    Light(30, [](std::size_t surface, int, int, Vec3f &color) {
        if (surface == 3)
            color = color + Vec3f{30, 30, 30};
    });
    const Comparison c = Compare(Written("b"), a, 500, 0);
    double all = 0;
    for (std::size_t i = 0; i < 6; ++i)
        all += compare::AreaOf(a.Map(), i);
    const double share = compare::AreaOf(a.Map(), 3) / all;
    EXPECT_LT(share, 0.01);
    EXPECT_NEAR(c.byArea.area, all, 1e-6 * all);
    EXPECT_NEAR(c.byArea.mean, 30 * share, 1e-3);
    EXPECT_NEAR(c.byArea.within8, 1 - share, 1e-9);
    EXPECT_NEAR(c.lightmaps.within8, 5.0 / 6, 1e-9) << "samples count alike";
}

TEST_F(CompareTest, WhatIsInSolidsIsLeftOut) {
    SceneBuilder scene;
    scene.SetInterior({0, 0, 0}, {256, 256, 256}, {"textures/test/wall0"});
    // A quarter of it is in the room, the rest in the wall beside.
    scene.AddQuad({{{192, 0, 64}, {192, 256, 64}, {448, 256, 64}, {448, 0, 64}}}, {"textures/test/shelf"});
    bsp = scene.Build();
    for (std::size_t i = 0; i < bsp.drawSurfaces.size(); ++i) {
        std::size_t buried = 0;
        for (const compare::SurfacePoint &point : compare::PointsOn(bsp, i, 1000))
            buried += compare::IsBuried(bsp, i, point);
        const bool shelf =
            FieldName(bsp.shaders[std::size_t(bsp.drawSurfaces[i].shaderNum)].shader) == "textures/test/shelf";
        EXPECT_NEAR(double(buried), shelf ? 750 : 0, 10) << i;
    }
}

TEST_F(CompareTest, AreasOfTrianglesAndPatches) {
    SceneBuilder scene;
    scene.SetInterior({0, 0, 0}, {256, 256, 256}, {"textures/test/wall0"});
    std::vector<Vec3f> points; // a parabola's arc of 128 x 64, 100 long
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 3; ++x)
            points.emplace_back(float(64 * x), float(50 * y), x == 1 ? 128.0f : 0.0f);
    scene.AddPatch(3, 3, points, {"textures/test/curve"});
    bsp = scene.Build();
    double flat = 0, curved = 0;
    for (std::size_t i = 0; i < bsp.drawSurfaces.size(); ++i)
        (bsp.drawSurfaces[i].surfaceType == MST_PATCH ? curved : flat) += compare::AreaOf(bsp, i);
    EXPECT_NEAR(flat, 6 * 256 * 256, 1);
    // z = 4 h t (1 - t), x = 128 t with h = 64: length by the closed form of a parabola's arc.
    const double a = 2.0, length = 64 * std::sqrt(1 + a * a) + 64 / a * std::asinh(a);
    EXPECT_NEAR(curved, 100 * length, 0.001 * 100 * length);
}

TEST_F(CompareTest, VerticesOfSkiesAreCountedApart) {
    Light(30);
    for (bspDrawSurface_t &s : bsp.drawSurfaces)
        s.lightmapNum[0] = kLightmapByVertex;
    LitMap a(bsp, {}, {});
    constexpr std::int32_t kSkyFlag = 0x4;
    bsp.shaders[std::size_t(bsp.drawSurfaces[0].shaderNum)].surfaceFlags |= kSkyFlag;
    std::size_t skies = 0;
    for (std::size_t i = 0; i < bsp.drawSurfaces.size(); ++i)
        skies += compare::IsUndrawn(bsp, i) ? std::size_t(bsp.drawSurfaces[i].numVerts) : 0;
    ASSERT_GT(skies, 0u);
    const LitMap sky(bsp, {}, {});
    const Comparison c = Compare(sky, a, 10, 0);
    EXPECT_EQ(c.undrawnVertices.count, skies);
    EXPECT_EQ(c.vertices.count, bsp.drawVerts.size() - skies);
    EXPECT_EQ(Compare(a, a, 10, 0).undrawnVertices.count, 0u);
    EXPECT_THAT(ToText(c), testing::HasSubstr("left out: those of skies"));
}

TEST_F(CompareTest, VerticesThatNobodySeesAreCountedApart) {
    const auto stage = [](std::string_view lines) {
        return fmt::format("\n{{\n{{\nmap $whiteimage\n{}\n}}\n}}\n", lines);
    };
    Script("textures/test/wall0" + stage("rgbGen wave sin 0 1 0 1") +              //
           "textures/test/wall1" + stage("rgbGen exactVertex") +                   //
           "textures/test/wall2" + stage("rgbgen vertex") +                        //
           "textures/test/wall3" + stage("") +                                     //
           "textures/test/wall4\n{\nqer_editorimage rgbGen\nq3map_bounce 1\n}\n"); // wall5: no script
    Light(30);
    for (bspDrawSurface_t &s : bsp.drawSurfaces)
        s.lightmapNum[0] = kLightmapByVertex;
    const LitMap a(bsp, {}, {});
    const Comparison c = Compare(a, a, 10, 0, library.get());
    const std::size_t one = std::size_t(bsp.drawSurfaces[0].numVerts);
    EXPECT_EQ(c.vertices.count, 3 * one) << "walls 1, 2 and 5";
    EXPECT_EQ(c.unseenVertices.count, 3 * one);
    EXPECT_THAT(ToText(c), testing::HasSubstr("left out: those that their shader does not draw: 12"));
    EXPECT_EQ(Compare(a, a, 10, 0).vertices.count, 6 * one) << "without the game's files";
}

TEST_F(CompareTest, DirectionsAreComparedInDegrees) {
    lightmap.deluxe = true;
    const auto towards = [&](const Vec3f &direction) {
        Light(30);
        for (RawLightmap &raw : surfaces.lightmaps)
            raw.directions.assign(raw.luxelClusters.size(), direction);
    };
    towards({0, 0, 1});
    const LitMap a = Written("a");
    EXPECT_TRUE(a.Deluxe());
    towards({0, 3, 3});
    const Comparison c = Compare(a, Written("b"), 50, 0);
    EXPECT_EQ(c.directions.count, 300u);
    EXPECT_NEAR(c.directions.mean, 45, 0.5);
}

TEST_F(CompareTest, OtherMapsAreRefused) {
    Light(30);
    const LitMap a = Written("a");
    bsp.drawSurfaces.pop_back();
    bsp.leafSurfaces.clear();
    for (bspLeaf_t &leaf : bsp.leafs)
        leaf.firstBSPLeafSurface = leaf.numBSPLeafSurfaces = 0;
    bsp.models[0].numBSPSurfaces = 5;
    const LitMap b(bsp, {}, {});
    EXPECT_THROW(Compare(a, b, 10, 0), Error);
}

TEST_F(CompareTest, PatchesAreSampledOnTheirCurves) {
    SceneBuilder scene;
    scene.SetInterior({0, 0, 0}, {256, 256, 256}, {"textures/test/wall0"});
    std::vector<Vec3f> points;
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 3; ++x)
            points.emplace_back(float(64 * x), float(32 * y), x == 1 ? 96.0f : 32.0f);
    scene.AddPatch(3, 5, points, {"textures/test/curve"});
    bsp = scene.Build();
    const LitMap map(bsp, {}, {});
    int checked = 0;
    for (std::size_t i = 0; i < bsp.drawSurfaces.size(); ++i) {
        if (bsp.drawSurfaces[i].surfaceType != MST_PATCH)
            continue;
        for (const compare::SurfacePoint &point : compare::PointsOn(bsp, i, 200)) {
            const Vec3d p = map.Position(point);
            const double t = p.x / 128;
            ASSERT_NEAR(p.z, 32 + 2 * t * (1 - t) * 64, 1e-3);
            ASSERT_TRUE(p.y >= 0 && p.y <= 128);
            ++checked;
        }
    }
    EXPECT_EQ(checked, 200);
}

} // namespace

} // namespace q3::test
