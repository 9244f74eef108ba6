// GPL-2.0-or-later. Directives of lightmaps, the kept text of shaders, and images that are freed.
#include "tests/support/library_fixture.h"

#include <gmock/gmock.h>

namespace q3 {
namespace {

using ShaderLightmap = test::LibraryTest;
using ShaderText = test::LibraryTest;
using ShaderImages = test::LibraryTest;

TEST_F(ShaderLightmap, DefaultsAreUnset) {
    const LightmapDirectives d = LoadShader("").lightmap;
    EXPECT_EQ(d.sampleSize, 0);
    EXPECT_EQ(d.sampleOffset, 0);
    EXPECT_EQ(d.axis, Vec3f{});
    EXPECT_EQ(d.pageSize, (std::array<int, 2>{0, 0}));
    EXPECT_EQ(d.brightness, 1);
    EXPECT_FALSE(d.mergable || d.splotchFix || d.noDirt || d.noVertexLight);
    EXPECT_EQ(d.shadeAngle, 0);
    EXPECT_EQ(d.floodIntensity, 0);
}

TEST_F(ShaderLightmap, NumbersAndSwitches) {
    const LightmapDirectives d = LoadShader("q3map_lightmapSampleSize 8\nq3map_lightmapSampleOffset 2.5\n"
                                            "q3map_lightmapAxis Y\nq3map_lightmapSize 512 256\n"
                                            "q3map_lightmapMergable\nq3map_splotchFix\nq3map_noDirty\n"
                                            "q3map_noVertexLight\nq3map_shadeAngle 60\n"
                                            "q3map_normalImage textures/a/bump.tga\nq3map_styleMarker2")
                                     .lightmap;
    EXPECT_EQ(d.sampleSize, 8);
    EXPECT_EQ(d.sampleOffset, 2.5f);
    EXPECT_EQ(d.axis, (Vec3f{0, 1, 0}));
    EXPECT_EQ(d.pageSize, (std::array<int, 2>{512, 256}));
    EXPECT_TRUE(d.mergable && d.splotchFix && d.noDirt && d.noVertexLight);
    EXPECT_EQ(d.shadeAngle, 60);
    EXPECT_EQ(d.normalImage, "textures/a/bump");
    EXPECT_EQ(LoadShader("q3map_terrain").lightmap.shadeAngle, 179);
}

/// `stage normalMap` makes an image a normal map, whose colors are not those of the surface.
TEST_F(ShaderLightmap, ImagesOfNormalMapStagesHaveNoColor) {
    WriteTga("textures/bump.tga", {{127, 127, 255, 255}});
    WriteTga("textures/color.tga", {{255, 0, 0, 255}});
    const ShaderInfo &info = LoadShader("{\nstage normalMap\nmap textures/bump.tga\n}\n{\nmap textures/color.tga\n}");
    EXPECT_EQ(info.averageColor, (Vec3f{255, 0, 0}));
    EXPECT_TRUE(library->HasNormalMap("s"));
    EXPECT_FALSE(LoadShader("{\nmap textures/color.tga\n}").normalMapStage);
    EXPECT_FALSE(library->HasNormalMap("s"));
    LoadShader("q3map_noRnm\n{\nstage bumpMap\nmap textures/bump.tga\n}");
    EXPECT_FALSE(library->HasNormalMap("s"));
}

TEST_F(ShaderLightmap, NormalImagesWinOverBumpMaps) {
    EXPECT_EQ(LoadShader("q3map_ssbumpImage textures/a/bump.png").lightmap.ssbumpImage, "textures/a/bump");
    EXPECT_EQ(Warnings("two normal maps"), 0);
    LoadShader("q3map_ssbumpImage textures/a/bump\nq3map_normalImage textures/a/normal");
    EXPECT_EQ(Warnings("two normal maps"), 1);
}

TEST_F(ShaderLightmap, BrightnessMultipliesAndNeverGetsNegative) {
    EXPECT_EQ(LoadShader("q3map_lightmapBrightness 2\nq3map_lightmapGamma 1.5").lightmap.brightness, 3);
    EXPECT_EQ(LoadShader("q3map_lightmapBrightness -2").lightmap.brightness, 1);
    EXPECT_TRUE(std::isfinite(
        LoadShader("q3map_lightmapBrightness 1e300\nq3map_lightmapBrightness 1e300").lightmap.brightness));
}

TEST_F(ShaderLightmap, WrongAxisAndPageSizeAreWarnings) {
    EXPECT_EQ(LoadShader("q3map_lightmapAxis x\nq3map_lightmapAxis xy").lightmap.axis, Vec3f{});
    EXPECT_EQ(Warnings("lightmap axis"), 1);
    for (const char *size : {"100 128", "128 0", "-256 256", "1 1", "1073741824 128"})
        EXPECT_EQ(LoadShader(fmt::format("q3map_lightmapSize {}", size)).lightmap.pageSize, (std::array<int, 2>{}))
            << size;
    EXPECT_EQ(Warnings("lightmap page size"), 5);
}

TEST_F(ShaderLightmap, FloodLight) {
    const LightmapDirectives d = LoadShader("q3map_floodLight 50 100 0 512 64 0.5").lightmap;
    EXPECT_EQ(d.floodColor, (Vec3f{0.5f, 1, 0}));
    EXPECT_EQ(d.floodDistance, 512);
    EXPECT_EQ(d.floodIntensity, 64);
    EXPECT_EQ(d.floodDirectionScale, 0.5f);
    EXPECT_EQ(LoadShader("q3map_floodLight 1 1 1 512").lightmap.floodIntensity, 0);
    EXPECT_EQ(Warnings("incomplete shader directive"), 1);
}

TEST_F(ShaderText, IsTidied) {
    const ShaderInfo &s = LoadShader("  qer_editorimage   a.tga // seen in the editor\n"
                                     "surfaceparm\ttrans; rest is a comment\n"
                                     "{ map $lightmap\n rgbGen identity }\n"
                                     "/* nothing\nhere */ cull none { }");
    EXPECT_EQ(s.scriptText, "{\n"
                            "\tqer_editorimage a.tga\n"
                            "\tsurfaceparm trans\n"
                            "\t{\n"
                            "\t\tmap $lightmap\n"
                            "\t\trgbGen identity\n"
                            "\t}\n"
                            "\tcull none\n"
                            "\t{\n"
                            "\t}\n"
                            "}\n");
}

// Text is made at look-up, but where a script includes others: both ways agree.
TEST_F(ShaderText, IsTheSameWithIncludes) {
    const std::string body =
        "\"qer_editorimage\" \"a b\" # comment\n{ map $lightmap\n} surfaceparm slick { }\n\"\" x\n";
    const std::string plain = LoadShader(body).scriptText;
    folder.Write("scripts/empty.inc", "");
    EXPECT_EQ(LoadShader(body + "$include scripts/empty.inc").scriptText, plain);
    folder.Write("scripts/body.inc", body);
    EXPECT_EQ(LoadShader("$include scripts/body.inc").scriptText, plain);
    LoadScript("$include scripts/empty.inc\nhalf {");
    EXPECT_EQ(Get("half").scriptText, "{\n}\n");
    LoadScript("half {");
    EXPECT_EQ(Get("half").scriptText, "{\n}\n");
}

TEST_F(ShaderText, WarningNamesTheLineOfTheDirectiveNotOfWhatItIncludes) {
    folder.Write("scripts/words.inc", "\n\n1 2\n");
    LoadShader("cull none\nq3map_sun $include scripts/words.inc");
    EXPECT_THAT(out.text,
                testing::HasSubstr("scripts/test.shader:4: shader s: q3map_sun with 0 arguments, expected 6"));
}

TEST_F(ShaderText, ReadsBackAsTheSameShader) {
    const ShaderInfo first = LoadShader("q3map_surfacelight 300\nq3map_lightImage \"a b\"\ncull none\n"
                                        "{\nmap $lightmap\n}\nq3map_sun 1 0.5 0.25 100 30 60\nsurfaceparm slick");
    LoadScript("s\n" + first.scriptText);
    const ShaderInfo &second = Get("s");
    EXPECT_EQ(second.scriptText, first.scriptText);
    EXPECT_EQ(second.surfaceLight, 300);
    EXPECT_TRUE(second.twoSided);
    EXPECT_EQ(second.surfaceFlags, first.surfaceFlags);
    ASSERT_EQ(second.suns.size(), 1u);
    EXPECT_EQ(second.suns[0].color, first.suns.at(0).color);
}

TEST_F(ShaderText, OnlyOfWhatTheEngineDraws) {
    LoadScript("a:q3map\n{\nq3map_surfacelight 100\n}\nb:q3map\n{\n{\nmap $lightmap\n}\n}\n"
               "c\n{\nq3map_baseShader b\nsurfaceparm slick\n}\nopen\n{\n{\nmap x.tga");
    EXPECT_EQ(Get("a").scriptText, "");
    EXPECT_EQ(Get("b").scriptText, "{\n\t{\n\t\tmap $lightmap\n\t}\n}\n");
    EXPECT_EQ(Get("c").scriptText, "{\n\tq3map_baseShader b\n\tsurfaceparm slick\n}\n");
    EXPECT_EQ(Get("open").scriptText, "{\n\t{\n\t\tmap x.tga\n\t}\n}\n");
    EXPECT_EQ(Get("implicit").scriptText, "");
}

TEST_F(ShaderText, ImplicitImages) {
    LoadScript("textures/a\n{\nimplicitMap -\n}\nb\n{\nimplicitMask textures/mask.tga\n}\nc\n{\nimplicitBlend d\n}\n");
    EXPECT_EQ(Get("textures/a").implicitMap, "textures/a");
    EXPECT_EQ(Get("b").implicitMask, "textures/mask");
    EXPECT_EQ(Get("b").implicitMap, "");
    EXPECT_EQ(Get("c").implicitBlend, "d");
}

TEST_F(ShaderImages, ThoseThatShadowsNeedStay) {
    WriteTga("plain.tga", {{200, 100, 50, 255}});
    WriteTga("grate.tga", {{10, 20, 30, 128}});
    WriteTga("sky.tga", {{1, 2, 3, 255}});
    LoadScript("plain\n{\n}\ngrate\n{\nsurfaceparm alphashadow\n}\nsky\n{\nsurfaceparm sky\n}\n");
    const std::array<const ShaderInfo *, 3> shaders = {&library->Get("plain"), &library->Get("grate"),
                                                       &library->Get("sky")};
    const auto red = [&](std::size_t i) { return int(shaders[i]->lightImage->Texel(0, 0)[0]); };
    library->ReleaseImages(KeptImages::OfReflectors);
    EXPECT_EQ(red(0), 200);
    EXPECT_EQ(red(1), 10);
    EXPECT_EQ(red(2), 255);
    library->ReleaseImages(KeptImages::SeeThrough);
    EXPECT_EQ(red(0), 255);
    EXPECT_EQ(red(1), 10);
    EXPECT_EQ(shaders[0]->averageColor, (Vec3f{200, 100, 50}));
    EXPECT_EQ(int(library->LoadImage("plain")->Texel(0, 0)[0]), 200);
}

TEST_F(ShaderImages, WhatGivesOrFiltersLightHasItsImageAtOnceOthersWithTheBounces) {
    WriteTga("a.tga", {{200, 100, 50, 255}});
    folder.Write("broken.tga", "no tga");
    LoadScript("lamp\n{\nq3map_surfacelight 100\nqer_editorImage a\n}\n"
               "sun\n{\nq3map_sun 1 1 1 100 0 90\nqer_editorImage a\n}\n"
               "sky\n{\nq3map_skyLight 100 3\nqer_editorImage a\n}\n"
               "grate\n{\nsurfaceparm alphashadow\nqer_editorImage a\n}\n"
               "glass\n{\nsurfaceparm lightfilter\nqer_editorImage a\n}\n"
               "wall\n{\nqer_editorImage a\n}\nbroken\n{\n}\n");
    for (const char *name : {"lamp", "sun", "sky", "grate", "glass"}) {
        EXPECT_TRUE(library->Get(name).imageFound) << name;
        EXPECT_EQ(library->Get(name).color, (Vec3f{1, 0.5f, 0.25f})) << name;
    }
    const ShaderInfo &wall = library->Get("wall");
    library->Get("broken");
    ASSERT_NE(wall.lightImage, nullptr);
    library->ReleaseImages(KeptImages::SeeThrough);
    EXPECT_FALSE(wall.imageFound);
    EXPECT_EQ(Warnings("damaged image"), 0);
    library->ReleaseImages(KeptImages::OfReflectors);
    EXPECT_TRUE(wall.imageFound);
    EXPECT_EQ(wall.averageColor, (Vec3f{200, 100, 50}));
    EXPECT_EQ(Warnings("damaged image"), 1);
}

} // namespace
} // namespace q3
