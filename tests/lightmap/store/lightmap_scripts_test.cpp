// GPL-2.0-or-later. Shaders made for light styles, hints to engines, and lightmaps that vertices stand for.
#include "q3map2/lightmap/store/lightmap_scripts.h"
#include "tests/support/store_fixture.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using ScriptsTest = StoreTest;
using testing::HasSubstr;
using testing::Not;

TEST_F(ScriptsTest, StyledLightIsAStageOfAMadeShader) {
    bsp.entities =
        "{\n\"classname\" \"worldspawn\"\n\"_style5rgbgen\" \"wave sin 1 2 3 4\"\n\"_style5alphagen\" \"const "
        "0.5\"\n}\n";
    MakeLightmaps(20, 20);
    for (std::uint32_t i = 0; i < 6; ++i)
        FillNoise(surfaces.lightmaps[i], i);
    FillNoise(surfaces.lightmaps[0], 77, 1);
    surfaces.lightmaps[0].styles[1] = 5;
    surfaces.styled = true;
    const std::string before(ShaderOf(0));
    const StoredLightmaps stored = Finish();
    ASSERT_EQ(stored.scripts.size(), 1u);
    EXPECT_EQ(ShaderOf(0), stored.scripts[0].shader);
    const std::string &text = stored.scripts[0].text;
    EXPECT_THAT(text, HasSubstr("map $lightmap\n\t\tblendFunc GL_SRC_ALPHA GL_ONE\n\t\trgbGen wave sin 1 2 3 4\n"
                                "\t\talphaGen const 0.5\n\t\ttcGen lightmap\n\t\ttcMod transform 1 0 0 1 "));
    EXPECT_THAT(text, HasSubstr("map " + before + ".tga\n\t\tblendFunc GL_DST_COLOR GL_ZERO"));
    EXPECT_THAT(text, Not(HasSubstr("styleMarker")));
    EXPECT_EQ(bsp.drawSurfaces[0].lightmapNum[0], 0) << "the first style stays in the file";
    // Half a page beside: the move leads from the first style to the second.
    const auto move = text.find("transform 1 0 0 1 ") + 18;
    const float s = std::stof(text.substr(move)), t = std::stof(text.substr(text.find(' ', move) + 1));
    const auto &at = bsp.drawVerts[std::size_t(bsp.drawSurfaces[0].firstVert)].lightmap[0];
    const auto column = std::size_t((at[0] + s) * 128), row = std::size_t((at[1] + t) * 128);
    const Vec3f &color = surfaces.lightmaps[0].result[1][0];
    EXPECT_EQ(int(stored.pages[0].colors[3 * (row * 128 + column)]), int(color.x));
}

TEST_F(ScriptsTest, MarkersOfScriptsAreReplaced) {
    Script("textures/test/wall0\n{\n\t{\n\t\tmap $lightmap\n\t}\n\tq3map_styleMarker2\n\t{\n\t\tmap "
           "textures/x.tga\n\t}\n}\n"
           "textures/test/wall1\n{\n\t{\n\t\tmap $lightmap\n\t}\n}\n");
    MakeLightmaps(100, 100);
    for (std::uint32_t i = 0; i < 6; ++i) {
        FillNoise(surfaces.lightmaps[i], i);
        const bool styled = ShaderOf(i).ends_with('0') || ShaderOf(i).ends_with('1');
        if (styled) {
            FillNoise(surfaces.lightmaps[i], 50 + i, 1);
            surfaces.lightmaps[i].styles[1] = 3;
        }
    }
    surfaces.styled = true;
    StoredLightmaps stored = Finish();
    ASSERT_EQ(stored.scripts.size(), 1u) << "no marker: the shader stays";
    const std::string &text = stored.scripts[0].text;
    EXPECT_THAT(text, HasSubstr("depthFunc equal\n\t\trgbGen wave noise 0.5 1 0 5.37\n"));
    EXPECT_THAT(text, HasSubstr("map textures/x.tga"));
    const auto at = text.find("maps/room/lm_");
    ASSERT_NE(at, std::string::npos) << "on a page of its own: as an image";
    const auto file = std::size_t(std::stoi(text.substr(at + 13)));
    EXPECT_TRUE(stored.pages.at(file).needsImage);

    const Bsp before = bsp;
    FinishForFile(lightmap, "room", stored, bsp);
    ASSERT_EQ(bsp.drawSurfaces.size(), before.drawSurfaces.size() + 1);
    EXPECT_THAT(stored.scripts.back().text, HasSubstr(" " + PagePath("room", int(file)) + "\n")) << "that page alone";
}

TEST_F(ScriptsTest, HintsKeepPagesWithoutMipmapsAndGoAgain) {
    lightmap.pageSize = {256, 256};
    MakeLightmaps(200, 200);
    for (std::uint32_t i = 0; i < 6; ++i)
        FillNoise(surfaces.lightmaps[i], i);
    StoredLightmaps stored = Finish();
    const Bsp before = bsp;
    FinishForFile(lightmap, "room", stored, bsp);
    ASSERT_EQ(bsp.drawSurfaces.size(), before.drawSurfaces.size() + 1);
    EXPECT_EQ(bsp.drawSurfaces[0].surfaceType, MST_FLARE);
    EXPECT_EQ(stored.scripts.back().shader, "maps/room/nomipmaps0");
    EXPECT_THAT(stored.scripts.back().text,
                HasSubstr("nomipmaps\n\t{\n\t\tanimMap .0042 maps/room/lm_0000.tga maps/room/lm_0001.tga"));
    EXPECT_EQ(bsp.models[0].firstBSPSurface, before.models[0].firstBSPSurface + 1);
    ValidateBsp(bsp, "room", log);
    for (std::size_t i = 0; i < before.leafSurfaces.size(); ++i)
        EXPECT_EQ(bsp.leafSurfaces[i], before.leafSurfaces[i] + 1);
    RemoveMipmapHints("another", bsp);
    EXPECT_EQ(bsp.drawSurfaces.size(), before.drawSurfaces.size() + 1) << "of another map";
    RemoveMipmapHints("room", bsp);
    bsp.shaders = before.shaders;
    EXPECT_EQ(WriteBsp(bsp, {}), WriteBsp(before, {}));
}

TEST_F(ScriptsTest, HintsOfALongMapNameAreFoundByTheirShaderAndGoAgain) {
    const std::string map(60, 'm');
    lightmap.pageSize = {256, 256};
    MakeLightmaps(200, 200);
    for (std::uint32_t i = 0; i < 6; ++i)
        FillNoise(surfaces.lightmaps[i], i);
    StoredLightmaps stored = Finish(1, map);
    const std::size_t count = bsp.drawSurfaces.size();
    FinishForFile(lightmap, map, stored, bsp);
    ASSERT_EQ(bsp.drawSurfaces.size(), count + 1);
    EXPECT_EQ(FieldName(bsp.shaders[std::size_t(bsp.drawSurfaces[0].shaderNum)].shader), stored.scripts.back().shader);
    RemoveMipmapHints(map, bsp);
    EXPECT_EQ(bsp.drawSurfaces.size(), count);
}

TEST_F(ScriptsTest, NamesDependOnTheTextAlone) {
    EXPECT_EQ(ShaderNameFor("a", "room"), ShaderNameFor("a", "room"));
    EXPECT_NE(ShaderNameFor("a", "room"), ShaderNameFor("b", "room"));
    EXPECT_EQ(ShaderNameFor("a", std::string(80, 'x')).size(), 63u) << "what a map can hold";
    EXPECT_TRUE(IsGeneratedName(ShaderNameFor("a", "room"), "room"));
    EXPECT_FALSE(IsGeneratedName("room/floor", "room"));
    EXPECT_FALSE(IsGeneratedName("textures/test/wall", "room"));
}

TEST_F(ScriptsTest, TriangleSoupHasNoLightmap) {
    bsp.drawSurfaces[1].surfaceType = MST_PATCH;
    bsp.drawSurfaces[1].lightmapNum[0] = 0;
    StoredLightmaps none;
    FinishForFile(lightmap, "room", none, bsp);
    EXPECT_EQ(bsp.drawSurfaces[0].surfaceType, MST_PLANAR);
    lightmap.triangleSoup = true;
    FinishForFile(lightmap, "room", none, bsp);
    EXPECT_EQ(bsp.drawSurfaces[0].surfaceType, MST_TRIANGLE_SOUP);
    EXPECT_EQ(bsp.drawSurfaces[0].lightmapNum[0], kLightmapByVertex);
    EXPECT_EQ(bsp.drawSurfaces[1].surfaceType, MST_PATCH);
    EXPECT_EQ(bsp.drawSurfaces[1].lightmapNum[0], 0);
}

/// The vertices' colors at the luxels of their corners.
void LightVerticesAs(const RawLightmap &raw, const bspDrawSurface_t &surface, std::vector<Vec3f> &vertices) {
    const int right = raw.width - 1, bottom = raw.height - 1;
    const std::array<std::size_t, 4> corners{raw.Index(0, 0), raw.Index(right, 0), raw.Index(right, bottom),
                                             raw.Index(0, bottom)};
    for (std::size_t v = 0; v < 4; ++v)
        vertices[std::size_t(surface.firstVert) + v] = raw.light[0][corners[v]];
}

TEST_F(ScriptsTest, EvenLightIsLeftToVertices) {
    MakeLightmaps(16, 16);
    surfaces.vertex.sum[0].resize(bsp.drawVerts.size());
    for (std::size_t i = 0; i < 6; ++i) {
        RawLightmap &raw = surfaces.lightmaps[i];
        Fill(raw, [&](int x, int y) { return Vec3f{float(40 + 4 * x), float(200 - 5 * y), 100}; });
        // A spot that no vertex knows of.
        if (i == 2)
            raw.light[0][raw.Index(5, 6)] = {220, 220, 220};
        LightVerticesAs(raw, bsp.drawSurfaces[i], surfaces.vertex.sum[0]);
    }
    lightmap.approximate = 3;
    Finish();
    for (std::size_t i = 0; i < 6; ++i)
        EXPECT_EQ(bsp.drawSurfaces[i].lightmapNum[0], i == 2 ? 0 : kLightmapByVertex) << i;
    lightmap.approximate = 0;
    Store();
    for (std::size_t i = 0; i < 6; ++i)
        EXPECT_EQ(bsp.drawSurfaces[i].lightmapNum[0], 0) << i;
}

TEST_F(ScriptsTest, VerticesStandInOnlyIfTheirStoredColorsShowTheSame) {
    MakeLightmaps(16, 16);
    surfaces.vertex.sum[0].resize(bsp.drawVerts.size());
    for (std::size_t i = 0; i < 6; ++i) {
        RawLightmap &raw = surfaces.lightmaps[i];
        Fill(raw, [&](int x, int) { return Vec3f{float(20 + 12 * x), 60, 100}; });
        LightVerticesAs(raw, bsp.drawSurfaces[i], surfaces.vertex.sum[0]);
    }
    lightmap.approximate = 8; // a luxel is compared with vertices up to half a luxel aside
    const Bsp unlit = bsp;
    const SurfaceLight before = surfaces;
    const auto byVertex = [&] {
        bsp = unlit, surfaces = before;
        Finish();
        return bsp.drawSurfaces[0].lightmapNum[0] == kLightmapByVertex;
    };
    EXPECT_TRUE(byVertex());
    lightmap.vertexScale = 1.2f;
    EXPECT_FALSE(byVertex()) << "vertices would be a fifth brighter";
    lightmap.vertexScale = 1;
    world.minVertex = {80, 80, 80};
    EXPECT_FALSE(byVertex()) << "their least light is another";
    world.minLight = world.minVertex;
    lightmap.approximate = 60; // a ramp between the ends, and one that is cut at 80
    EXPECT_TRUE(byVertex());
    world = {};
    lightmap.approximate = 8;
    options.tone.gamma = 2;
    EXPECT_FALSE(byVertex()) << "engines blend the bytes, whose ramp is no longer straight";
    options.tone = {};
    surfaces = before;
    for (RawLightmap &raw : surfaces.lightmaps) {
        raw.styles[1] = 5;
        Fill(
            raw,
            [](int, int) {
                return Vec3f{40, 40, 40};
            },
            1);
    }
    Finish();
    EXPECT_EQ(bsp.drawSurfaces[0].lightmapNum[0], 0) << "vertices cannot flicker";
}

// A stripe that points at most 3 luxels apart cannot step over.
TEST_F(ScriptsTest, VerticesAreComparedAsDenselyAsTheThresholdSays) {
    MakeLightmaps(16, 16);
    surfaces.vertex.sum[0].resize(bsp.drawVerts.size());
    for (std::size_t i = 0; i < 6; ++i) {
        RawLightmap &raw = surfaces.lightmaps[i];
        Fill(raw, [&](int x, int) { return i == 0 && x >= 5 && x < 8 ? Vec3f{200, 200, 200} : Vec3f{50, 60, 70}; });
        LightVerticesAs(raw, bsp.drawSurfaces[i], surfaces.vertex.sum[0]);
    }
    lightmap.approximate = 3;
    lightmap.threshold = 3;
    Finish();
    for (std::size_t i = 0; i < 6; ++i)
        EXPECT_EQ(bsp.drawSurfaces[i].lightmapNum[0], i == 0 ? 0 : kLightmapByVertex) << i;
}

TEST_F(ScriptsTest, SmallSurfacesAreLeftToVerticesUnlessTheirShaderKeepsThem) {
    Script("textures/test/wall1\n{\nq3map_noVertexLight\n}\n");
    MakeLightmaps(16, 16);
    surfaces.vertex.sum[0].resize(bsp.drawVerts.size());
    for (std::uint32_t i = 0; i < 6; ++i) {
        FillNoise(surfaces.lightmaps[i], i);
        surfaces.lightmaps[i].sampleSize = i == 0 ? 16 : 128;
    }
    lightmap.approximate = 1;
    Finish();
    for (std::size_t i = 0; i < 6; ++i)
        EXPECT_EQ(bsp.drawSurfaces[i].lightmapNum[0], i == 0 || ShaderOf(i).ends_with('1') ? 0 : kLightmapByVertex) << i;
}

} // namespace

} // namespace q3::test
