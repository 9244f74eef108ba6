// GPL-2.0-or-later. What storing writes into a file: every luxel is shown where it belongs.
#include "q3map2/lightmap/store/lightmap_scripts.h"
#include "tests/support/store_fixture.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using testing::HasSubstr;

/// Every used luxel of every lightmap is on the page where its surface's coordinates lead.
void ExpectAllShown(const std::function<std::array<int, 3>(std::size_t, int, int)> &shown,
                    const SurfaceLight &surfaces) {
    for (std::size_t i = 0; i < surfaces.lightmaps.size(); ++i) {
        const RawLightmap &raw = surfaces.lightmaps[i];
        for (int y = 0; y < raw.height; ++y)
            for (int x = 0; x < raw.width; ++x) {
                const Vec3f &color = raw.result[0][raw.Index(x, y)];
                if (color.x < 0)
                    continue;
                ASSERT_EQ(shown(i, x, y), (std::array{int(color.x), int(color.y), int(color.z)}))
                    << "surface " << i << " luxel " << x << ' ' << y;
            }
    }
}

TEST_F(StoreTest, EveryLuxelIsShownWhereItsSurfaceIs) {
    MakeLightmaps(61, 37);
    for (std::uint32_t i = 0; i < 6; ++i)
        FillNoise(surfaces.lightmaps[i], i);
    const StoredLightmaps stored = Finish();
    ASSERT_EQ(stored.pages.size(), 1u) << "six of them fit on one page";
    EXPECT_EQ(bsp.lightmaps, stored.pages[0].colors);
    ExpectAllShown([&](std::size_t i, int x, int y) { return Shown(stored, i, x, y); }, surfaces);
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces)
        EXPECT_EQ((std::array{surface.lightmapX[0], surface.lightmapY[0], surface.lightmapWidth, surface.lightmapHeight}),
                  (std::array{0, 0, 0, 0}));
}

TEST_F(StoreTest, HolesAreSharedAndNothingIsOverwritten) {
    MakeLightmaps(60, 60);
    for (std::uint32_t i = 0; i < 6; ++i) {
        RawLightmap &raw = surfaces.lightmaps[i];
        FillNoise(raw, i);
        for (int y = 0; y < 60; ++y)
            for (int x = 0; x < 60; ++x)
                if (i % 2 == 0 ? x + y > 59 : x + y < 59)
                    Unmap(raw, x, y);
    }
    const StoredLightmaps stored = Finish();
    ExpectAllShown([&](std::size_t i, int x, int y) { return Shown(stored, i, x, y); }, surfaces);
}

TEST_F(StoreTest, SuperSamplingKeepsCoordinates) {
    MakeLightmaps(20, 10, 3);
    for (std::uint32_t i = 0; i < 6; ++i)
        FillNoise(surfaces.lightmaps[i], i);
    const StoredLightmaps stored = Finish();
    ExpectAllShown([&](std::size_t i, int x, int y) { return Shown(stored, i, x, y); }, surfaces);
    const auto &a = bsp.drawVerts[0].lightmap[0], &c = bsp.drawVerts[2].lightmap[0];
    EXPECT_FLOAT_EQ((c[0] - a[0]) * 128, 19);
    EXPECT_FLOAT_EQ((c[1] - a[1]) * 128, 9);
}

TEST_F(StoreTest, ThreadsMakeNoDifference) {
    MakeLightmaps(50, 41);
    for (std::uint32_t i = 0; i < 6; ++i)
        FillNoise(surfaces.lightmaps[i], i / 2);
    const SurfaceLight before = surfaces;
    const Bsp unlit = bsp;
    Finish(1);
    const Bsp one = bsp;
    bsp = unlit, surfaces = before;
    Finish(3);
    EXPECT_EQ(WriteBsp(one, {}), WriteBsp(bsp, {}));
}

TEST_F(StoreTest, AlikeLightmapsShareTheirPlaceAndPlainOnesTakeOneTexel) {
    MakeLightmaps(100, 100);
    for (const std::size_t i : {0u, 1u, 2u})
        FillNoise(surfaces.lightmaps[i], 5);
    // One channel of one luxel off by more than what is alike.
    surfaces.lightmaps[2].light[0][5050].x += 4;
    for (const std::size_t i : {3u, 4u, 5u})
        Fill(surfaces.lightmaps[i], [&](int, int) { return Vec3f{40, float(i == 5 ? 90 : 50), 60}; });
    const Bsp unlit = bsp;
    const SurfaceLight before = surfaces;
    const StoredLightmaps stored = Finish();
    EXPECT_EQ(stored.pages.size(), 2u);
    const auto first = [&](std::size_t i) {
        return bsp.drawVerts[std::size_t(bsp.drawSurfaces[i].firstVert)].lightmap[0];
    };
    EXPECT_EQ(first(0), first(1));
    EXPECT_EQ(bsp.drawSurfaces[0].lightmapNum[0], bsp.drawSurfaces[1].lightmapNum[0]);
    EXPECT_NE(bsp.drawSurfaces[0].lightmapNum[0], bsp.drawSurfaces[2].lightmapNum[0]);
    EXPECT_EQ(first(3), first(4));
    EXPECT_NE(first(3), first(5));
    EXPECT_EQ(Shown(stored, 5, 0, 0), (std::array{40, 90, 60}));
    for (int v = 0; v < 4; ++v)
        EXPECT_EQ(bsp.drawVerts[std::size_t(bsp.drawSurfaces[3].firstVert + v)].lightmap[0], first(3)) << "one texel";
    bsp = unlit, surfaces = before;
    lightmap.collapse = false;
    EXPECT_EQ(Finish().pages.size(), 6u) << "-nocollapse keeps all apart";
}

TEST_F(StoreTest, TwinsShowTheirMean) {
    MakeLightmaps(10, 10);
    for (std::size_t i = 0; i < 6; ++i)
        Fill(surfaces.lightmaps[i], [&](int x, int y) {
            return Vec3f{float(x * 20), float(y * 20), i == 1 ? 101.5f : i == 0 ? 100.0f : float(10 * i)};
        });
    const StoredLightmaps stored = Finish();
    EXPECT_EQ(Shown(stored, 0, 4, 5), (std::array{80, 100, 100}));
    EXPECT_EQ(Shown(stored, 1, 4, 5), (std::array{80, 100, 100}));
    EXPECT_EQ(Shown(stored, 2, 4, 5), (std::array{80, 100, 20}));
}

TEST_F(StoreTest, LeastLightRaisesLuxelsAndVertices) {
    MakeLightmaps(4, 4);
    for (std::size_t i = 0; i < 6; ++i)
        Fill(surfaces.lightmaps[i], [&](int x, int) { return Vec3f{float(10 * x), float(i), 200}; });
    surfaces.vertex.sum[0].assign(bsp.drawVerts.size(), {1, 90, 300});
    for (bspDrawVert_t &vert : bsp.drawVerts)
        vert.color[0] = {9, 9, 9, 77};
    world.minLight = {15, 15, 15};
    world.minVertex = {5, 6, 7};
    const StoredLightmaps stored = Finish();
    EXPECT_EQ(Shown(stored, 2, 1, 0), (std::array{15, 15, 200}));
    EXPECT_EQ(Shown(stored, 2, 3, 0), (std::array{30, 15, 200}));
    // 300 is over white: the color keeps its hue.
    EXPECT_EQ(bsp.drawVerts[0].color[0], (std::array<std::uint8_t, 4>{4, 76, 255, 77})) << "alpha stays";
}

TEST_F(StoreTest, VertexLightFollowsScalesAndDirectives) {
    Script("textures/test/wall1\n{\nq3map_noVertexLight\n}\ntextures/test/wall2\n{\nq3map_vertexScale 3\n}\n");
    MakeLightmaps(4, 4);
    surfaces.vertex.sum[0].assign(bsp.drawVerts.size(), {10, 20, 30});
    lightmap.vertexScale = 2;
    for (bspDrawVert_t &vert : bsp.drawVerts)
        vert.color[0] = {9, 9, 9, 77};
    Store();
    for (std::size_t i = 0; i < bsp.drawSurfaces.size(); ++i) {
        const auto &color = bsp.drawVerts[std::size_t(bsp.drawSurfaces[i].firstVert)].color[0];
        const std::string_view shader = ShaderOf(i);
        const int red = shader.ends_with('1') ? 9 : shader.ends_with('2') ? 60 : 20;
        EXPECT_EQ(int(color[0]), red) << shader;
        EXPECT_EQ(bsp.drawSurfaces[i].lightmapNum[0], kLightmapByVertex) << "nothing was averaged";
    }
}

TEST_F(StoreTest, BrightnessAndToneChangeBytes) {
    MakeLightmaps(3, 3);
    for (std::size_t i = 0; i < 6; ++i)
        Fill(surfaces.lightmaps[i], [&](int x, int y) {
            return Vec3f{float(10 * x + 1), float(10 * y + 1), float(i)};
        });
    surfaces.lightmaps[1].brightness = 4;
    options.tone.compensate = 2;
    const StoredLightmaps stored = Finish();
    EXPECT_EQ(Shown(stored, 0, 2, 1), (std::array{10, 5, 0}));
    EXPECT_EQ(Shown(stored, 1, 2, 1), (std::array{42, 22, 2}));
}

TEST_F(StoreTest, SeamsOfClosedSurfacesMeet) {
    MakeLightmaps(8, 4);
    FillNoise(surfaces.lightmaps[0], 1);
    for (std::size_t i = 1; i < 6; ++i)
        Fill(surfaces.lightmaps[i], [](int, int) { return Vec3f{}; });
    surfaces.lightmaps[0].wrapS = true;
    const StoredLightmaps stored = Finish();
    const std::vector<Vec3f> &luxels = surfaces.lightmaps[0].result[0];
    for (int y = 0; y < 4; ++y) {
        EXPECT_EQ(Shown(stored, 0, 0, y), Shown(stored, 0, 7, y));
        const std::size_t row = std::size_t(8 * y);
        EXPECT_EQ(Shown(stored, 0, 0, y), Bytes((luxels[row] + luxels[row + 7]) * 0.5f));
        EXPECT_EQ(Shown(stored, 0, 3, y), Bytes(luxels[row + 3]));
    }
}

TEST_F(StoreTest, UnusedTexelsAreBlackPinkOrFilled) {
    const auto pageWith = [&](bool fill, bool pink) {
        MakeLightmaps(10, 10);
        for (std::size_t i = 0; i < 6; ++i)
            Fill(surfaces.lightmaps[i], [&](int x, int y) { return Vec3f{float(100 + x), float(100 + y), 150}; });
        lightmap.fill = fill, lightmap.fillPink = pink;
        return Finish().pages.at(0).colors;
    };
    const auto at = [](const std::vector<std::uint8_t> &page, std::size_t texel) {
        return std::array{int(page[3 * texel]), int(page[3 * texel + 1]), int(page[3 * texel + 2])};
    };
    EXPECT_EQ(at(pageWith(false, false), 128 * 128 - 1), (std::array{0, 0, 0}));
    EXPECT_EQ(at(pageWith(false, true), 128 * 128 - 1), (std::array{255, 0, 255}));
    const std::vector<std::uint8_t> filled = pageWith(true, true);
    for (std::size_t i = 0; i < 128 * 128; ++i)
        ASSERT_TRUE(filled[3 * i] >= 100 && filled[3 * i] < 110 && filled[3 * i + 2] == 150) << i;
    // Beside the first row of the block at (0, 0), across the page's edge.
    EXPECT_EQ(at(filled, 127), (std::array{100, 100, 150}));
}

TEST_F(StoreTest, SurfacesWithAParentCopyItsLight) {
    MakeLightmaps(6, 6);
    for (std::uint32_t i = 0; i < 6; ++i)
        FillNoise(surfaces.lightmaps[i], i);
    surfaces.vertex.sum[0].assign(bsp.drawVerts.size(), {10, 20, 30});
    surfaces.vertex.sum[0][0] = {50, 60, 70};
    table[4].parent = 0;
    surfaces.lightmapOf[4] = -1;
    const bspDrawSurface_t before = bsp.drawSurfaces[4];
    Finish();
    EXPECT_EQ(bsp.drawSurfaces[4].lightmapNum[0], bsp.drawSurfaces[0].lightmapNum[0]);
    EXPECT_EQ(bsp.drawSurfaces[4].firstVert, before.firstVert);
    EXPECT_EQ(bsp.drawSurfaces[4].lightmapVecs, before.lightmapVecs);
    for (int v = 0; v < 4; ++v) {
        const bspDrawVert_t &copy = bsp.drawVerts[std::size_t(before.firstVert + v)],
                            &own = bsp.drawVerts[std::size_t(v)];
        EXPECT_EQ(copy.lightmap, own.lightmap);
        EXPECT_EQ(copy.color, own.color);
    }
}

TEST_F(StoreTest, LightDirectionsFollowEachPage) {
    MakeLightmaps(20, 20);
    lightmap.deluxe = true;
    for (std::uint32_t i = 0; i < 6; ++i) {
        FillNoise(surfaces.lightmaps[i], i);
        surfaces.lightmaps[i].directions.assign(400, Vec3f{float(i), 3, 4} * 7.0f);
    }
    StoredLightmaps stored = Finish();
    ASSERT_EQ(bsp.lightmaps.size(), 2u * 128 * 128 * 3);
    EXPECT_EQ(bsp.drawSurfaces[3].lightmapNum[0], 0);
    EXPECT_EQ(Direction(stored, 0, 7, 7), (std::array{127, 204, 229})) << "(0, 0.6, 0.8)";
    EXPECT_TRUE(std::equal(stored.pages[0].directions.begin(), stored.pages[0].directions.end(),
                           bsp.lightmaps.begin() + 128 * 128 * 3));
    lightmap.debugDeluxe = true;
    stored = Store();
    EXPECT_EQ(bsp.drawSurfaces[3].lightmapNum[0], 1) << "-debugdeluxe shows the directions";
}

TEST_F(StoreTest, TangentSpaceHasTheNormalAsItsThirdAxis) {
    MakeLightmaps(20, 20);
    lightmap.deluxe = lightmap.deluxeTangent = true;
    for (std::uint32_t i = 0; i < 6; ++i) {
        RawLightmap &raw = surfaces.lightmaps[i];
        FillNoise(raw, i);
        raw.directions.assign(400, i < 3 ? raw.planeNormal * 5.0f : Vec3f{1, 2, 3});
    }
    const StoredLightmaps stored = Finish();
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(Direction(stored, i, 3, 3), (std::array{127, 127, 255})) << i;
    for (std::size_t i = 3; i < 6; ++i) {
        const float wanted = Dot(surfaces.lightmaps[i].planeNormal, Normalize(Vec3f{1, 2, 3}));
        EXPECT_NEAR(float(Direction(stored, i, 3, 3)[2]), 127.5f + 127.5f * wanted, 1) << i;
    }
}

TEST_F(StoreTest, ExternalPagesLeaveTheLumpEmpty) {
    lightmap.external = true;
    lightmap.deluxe = true;
    lightmap.pageSize = {64, 32};
    MakeLightmaps(60, 30);
    for (std::uint32_t i = 0; i < 6; ++i) {
        FillNoise(surfaces.lightmaps[i], i);
        surfaces.lightmaps[i].directions.assign(1800, {0, 0, 1});
    }
    bsp.lightmaps.assign(128 * 128 * 3, 1);
    const StoredLightmaps stored = Finish();
    EXPECT_TRUE(bsp.lightmaps.empty());
    ASSERT_EQ(stored.pages.size(), 6u);
    for (int i = 0; i < 6; ++i) {
        EXPECT_EQ(stored.pages[std::size_t(i)].number, 2 * i) << "light is even, directions odd";
        EXPECT_EQ(stored.pages[std::size_t(i)].file, 2 * i);
        EXPECT_TRUE(stored.pages[std::size_t(i)].needsImage);
        EXPECT_EQ(stored.pages[std::size_t(i)].height, 32);
    }
    ExpectAllShown([&](std::size_t i, int x, int y) { return Shown(stored, i, x, y); }, surfaces);
}

TEST_F(StoreTest, PagesOfAnotherSizeAreShownByMadeShaders) {
    Script("textures/test/wall1\n{\n\tcull none\n\t{\n\t\tmap $Lightmap\n\t}\n}\n"
           "textures/test/wall2\n{\n\t{\n\t\tmap textures/x.tga\n\t}\n}\n");
    lightmap.pageSize = {256, 256};
    MakeLightmaps(200, 30);
    for (std::uint32_t i = 0; i < 6; ++i)
        FillNoise(surfaces.lightmaps[i], i);
    const StoredLightmaps stored = Finish();
    EXPECT_TRUE(bsp.lightmaps.empty());
    ASSERT_EQ(stored.pages.size(), 1u);
    EXPECT_TRUE(stored.pages[0].needsImage);
    EXPECT_EQ(stored.scripts.size(), 5u) << "all but the shader without lightmap";
    int own = 0, kept = 0;
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(bsp.drawSurfaces[i].lightmapNum[0], kLightmapByVertex);
        const std::string shader(ShaderOf(i));
        const auto script = std::find_if(stored.scripts.begin(), stored.scripts.end(),
                                         [&](const auto &one) { return one.shader == shader; });
        if (script == stored.scripts.end()) {
            EXPECT_EQ(shader, "textures/test/wall2");
            ++kept;
            continue;
        }
        EXPECT_THAT(script->text, HasSubstr("map maps/room/lm_0000.tga\n\t\ttcGen lightmap"));
        EXPECT_THAT(script->text, testing::Not(HasSubstr("styleMarker"))) << "nothing flickers";
        own += script->text.find("cull none") != std::string::npos;
        EXPECT_TRUE(IsGeneratedName(shader, "room"));
    }
    EXPECT_EQ(own, 1);
    EXPECT_EQ(kept, 1);
    // Lit again in pages of the usual size: the shaders of the map are back.
    lightmap.pageSize = {128, 128};
    for (RawLightmap &raw : surfaces.lightmaps)
        raw.pageSize = {256, 256};
    lightmap.gamePageSize = {256, 256};
    Store();
    for (std::size_t i = 0; i < 6; ++i)
        EXPECT_TRUE(ShaderOf(i).starts_with("textures/test/wall")) << ShaderOf(i);
}

} // namespace

} // namespace q3::test
