// GPL-2.0-or-later. Grammar and directives of shader scripts.
#include "tests/support/library_fixture.h"

#include <gmock/gmock.h>

namespace q3 {
namespace {

using test::kDust, test::kSlick;
using testing::HasSubstr;

using ShaderGrammar = test::LibraryTest;
using ShaderDirectives = test::LibraryTest;

constexpr std::uint32_t kMetal = 0x1000;

TEST_F(ShaderGrammar, QuotedNamesAndHiddenEntries) {
    LoadScript("\"a b\"\n{\nsurfaceparm slick\n}\nhidden:q3map { \nsurfaceparm dust\n}\n");
    EXPECT_EQ(Get("a b").surfaceFlags, kSlick);
    EXPECT_EQ(Get("hidden").surfaceFlags, kDust);
    EXPECT_EQ(Get("hidden").name, "hidden");
    EXPECT_EQ(library->DefinedCount(), 2u);
}

TEST_F(ShaderGrammar, ADirectiveEndsAtABrace) {
    LoadScript("one {\nsurfaceparm slick surfaceparm dust\n}\n"
               "foo { surfaceparm slick { map x.tga } }\n"
               "bar\n{\nqer_editorImage x }\n"
               "sky\n{\nq3map_sun 1 1 1 100 0 90 }\n"
               "unknown\n{\nq3map_noSuchThing 4 }\n"
               "last\n{\nsurfaceparm metalsteps\n}\n");
    EXPECT_EQ(Get("one").surfaceFlags, kSlick);
    EXPECT_EQ(Get("foo").surfaceFlags, kSlick);
    EXPECT_EQ(Get("foo").scriptText, "{\n\tsurfaceparm slick\n\t{\n\t\tmap x.tga\n\t}\n}\n");
    for (const char *name : {"bar", "sky", "unknown", "last"})
        EXPECT_TRUE(Get(name).defined) << name;
    EXPECT_EQ(Warnings("missing brace in a script"), 0);
}

TEST_F(ShaderGrammar, AMissingBraceIsNamedAndTheNextShaderRead) {
    LoadScript("textures/a\n{\nsurfaceparm slick\n\ntextures/b\n{\nsurfaceparm dust\n}\n");
    EXPECT_THAT(out.text,
                HasSubstr("scripts/test.shader:5: shader textures/a: a '}' is missing: the shader that begins "
                          "in line 2 is not closed before shader textures/b"));
    EXPECT_EQ(Get("textures/a").surfaceFlags, kSlick);
    EXPECT_EQ(Get("textures/b").surfaceFlags, kDust);
    EXPECT_EQ(Get("textures/a").scriptText, "{\n\tsurfaceparm slick\n}\n");
    // Both braces are missing, of a stage and its shader.
    LoadScript("textures/a\n{\nsurfaceparm slick\n{\nmap textures/x.tga\n\"textures/b\" // next\n{\nsurfaceparm "
               "dust\n}\n");
    EXPECT_EQ(Warnings("missing brace in a script"), 2);
    EXPECT_EQ(Get("textures/a").scriptText, "{\n\tsurfaceparm slick\n\t{\n\t\tmap textures/x.tga\n\t}\n}\n");
    EXPECT_EQ(Get("textures/b").surfaceFlags, kDust);
    // Only that of the stage: what should close the shader closes the stage.
    LoadScript("textures/a\n{\n{\nmap x\n}\ntextures/b\n{\nsurfaceparm dust\n}\n");
    EXPECT_EQ(Get("textures/b").surfaceFlags, kDust);
}

TEST_F(ShaderGrammar, AStageWithinAStageIsNamed) {
    LoadScript("textures/a\n{\n{\nmap x\n{\nmap y\n}\n}\n");
    EXPECT_THAT(out.text, HasSubstr("scripts/test.shader:5: shader textures/a: a '}' is missing: the stage that begins "
                                    "in line 3 is not closed before the next '{'"));
}

TEST_F(ShaderGrammar, AFileThatEndsWithinAShaderIsNamed) {
    LoadScript("textures/a\n{\nsurfaceparm slick\n");
    EXPECT_THAT(out.text,
                HasSubstr("scripts/test.shader:3: shader textures/a: a '}' is missing: the shader that begins "
                          "in line 2 is not closed before the end of the file"));
    EXPECT_EQ(Get("textures/a").surfaceFlags, kSlick);
}

TEST_F(ShaderGrammar, ArgumentsOnTheNextLineAreNoShader) {
    LoadScript("textures/a\n{\nqer_editorImage\ntextures/x\n{\nmap y\n}\n}\n"
               "textures/b\n{\nsurfaceparm dust\n}\n");
    EXPECT_EQ(Warnings("incomplete shader directive"), 1);
    EXPECT_EQ(Warnings("missing brace in a script"), 0);
    EXPECT_FALSE(Get("textures/x").defined);
    EXPECT_EQ(Get("textures/b").surfaceFlags, kDust);
}

TEST_F(ShaderGrammar, SemicolonEndsTheArgument) {
    EXPECT_EQ(LoadShader("surfaceparm slick;surfaceparm dust").surfaceFlags, kSlick);
    EXPECT_EQ(Warnings("unknown surfaceparm"), 0);
}

TEST_F(ShaderGrammar, UnknownDirectives) {
    EXPECT_EQ(LoadShader("noSuchThing surfaceparm dust\nqer_trans 0.4\nq3map_slick\nq3map_noSuchThing 4").surfaceFlags,
              kSlick);
    EXPECT_EQ(Warnings("unknown shader directive"), 2);
    EXPECT_THAT(out.text, HasSubstr("scripts/test.shader:3: shader s: unknown directive noSuchThing"));
    out.log.FlushWarnings();
    LoadShader("q3map_surfacelite 100");
    EXPECT_THAT(out.text, HasSubstr("q3map_surfacelite; did you mean q3map_surfaceLight?"));
}

TEST_F(ShaderGrammar, DirectivesOfEnginesAndEditorsAreKnown) {
    LoadShader("noPicMip\nnomipmaps\nsort 5\nportal\nfogparms ( 1 1 1 ) 512\nqer_nocarve\nq3map_vertexShadows\n"
               "tessSize 64\ndpReflectCube env/x\nclampTime 2\npolygonOffset\nlight 1\nspecularMap x");
    EXPECT_EQ(Warnings("unknown shader directive"), 0);
}

TEST_F(ShaderGrammar, DirectivesOfOtherStagesAreKnown) {
    LoadShader(
        "q3map_terrain\nq3map_shadeAngle 60\nq3map_tcGen ivector ( 256 0 0 ) ( 0 256 0 )\nq3map_alphaMod "
        "volume\nq3map_vertexShadows\n"
        "q3map_lightmapSampleSize 16\nq3map_styleMarker2\nq3map_tessSize 64\nq3map_surfaceModel a 1 1 1 1 1 1 1");
    EXPECT_EQ(Warnings("unknown shader directive"), 0);
}

TEST_F(ShaderGrammar, EndOfFileClosesTheLastShader) {
    LoadScript("a\n{\nsurfaceparm slick\n{\nmap textures/x.tga");
    EXPECT_EQ(Get("a").surfaceFlags, kSlick);
    EXPECT_EQ(library->DefinedCount(), 1u);
}

TEST_F(ShaderGrammar, ANameThatNoMapCanHoldIsAWarning) {
    LoadScript(std::string(63, 'a') + "\n{\n}\n" + std::string(64, 'b') + "\n{\nsurfaceparm slick\n}\n");
    EXPECT_EQ(Warnings("long shader name"), 1);
    EXPECT_THAT(out.text, HasSubstr(std::string(64, 'b') + " is longer than the 63 bytes that a map can hold"));
    EXPECT_EQ(Get(std::string(64, 'b')).surfaceFlags, kSlick);
}

TEST_F(ShaderDirectives, ASunWithADevianceNeedsSamples) {
    const ShaderInfo &shader = LoadShader("q3map_sunExt 1 1 1 100 0 90 5");
    EXPECT_EQ(Warnings("incomplete shader directive"), 1);
    EXPECT_THAT(out.text, HasSubstr("shader s: a sun with a deviance but no samples"));
    ASSERT_EQ(shader.suns.size(), 1u);
    EXPECT_EQ(shader.suns[0].deviance, 0);
}

TEST_F(ShaderGrammar, GlobalFlagsAreSurfaceparmsOfTheGame) {
    options.globalFlags = {"slick"};
    EXPECT_EQ(LoadShader("surfaceparm dust").surfaceFlags, kSlick | kDust);
    options.globalFlags = {"glue"};
    EXPECT_THAT([this] { Load(); },
                testing::ThrowsMessage<Error>(HasSubstr("-globalflag glue: no surfaceparm of game quake3")));
}

TEST_F(ShaderGrammar, MissingArgumentSkipsTheDirectiveOnly) {
    const ShaderInfo &shader =
        LoadShader("q3map_surfacelight\nq3map_sun 1 1 1 100\nq3map_lightRGB 1 0 // 0\nsurfaceparm\nsurfaceparm slick");
    EXPECT_EQ(shader.surfaceLight, 0);
    EXPECT_TRUE(shader.suns.empty());
    EXPECT_EQ(shader.surfaceFlags, kSlick);
    EXPECT_EQ(Warnings("incomplete shader directive"), 4);
    EXPECT_THAT(out.text, HasSubstr("scripts/test.shader:3"));
}

TEST_F(ShaderGrammar, NameWithoutBraceIsAWarning) {
    LoadScript("stray\na\n{\nsurfaceparm slick\n}\nlast");
    EXPECT_EQ(Get("a").surfaceFlags, kSlick);
    EXPECT_FALSE(Get("stray").defined);
    EXPECT_EQ(Warnings("shader syntax"), 2);
    LoadScript("last");
    EXPECT_EQ(library->DefinedCount(), 0u);
}

TEST_F(ShaderGrammar, DamagedScriptKeepsWhatStoodBefore) {
    LoadScript("a\n{\nsurfaceparm slick\n}\nb\n{\nfoo \"" + std::string(3000, 'x'));
    EXPECT_TRUE(Get("a").defined);
    EXPECT_FALSE(Get("b").defined);
    EXPECT_EQ(Warnings("damaged shader script"), 1);
}

TEST_F(ShaderGrammar, StageHasNoLinesAndNoDirectives) {
    const ShaderInfo &shader = LoadShader("{ map\n$whiteimage surfaceparm dust }\nsurfaceparm slick");
    EXPECT_EQ(shader.surfaceFlags, kSlick);
}

TEST_F(ShaderGrammar, IncludeInABody) {
    folder.Write("scripts/common.inc", "surfaceparm dust\nsurfaceparm metalsteps\n");
    const ShaderInfo &shader =
        LoadShader("surfaceparm slick\n$include scripts/common.inc\n$include scripts/gone.inc\nq3map_bounce 3");
    EXPECT_EQ(shader.surfaceFlags, kSlick | kDust | kMetal);
    EXPECT_EQ(shader.bounceScale, 3);
    EXPECT_EQ(Warnings("include not found"), 1);
}

TEST_F(ShaderDirectives, SurfaceParmsApplyInOrder) {
    const ShaderInfo water = LoadShader("surfaceparm water");
    EXPECT_EQ(water.contentFlags, 0x20u);
    EXPECT_EQ(water.compileFlags, std::uint32_t(C_TRANSLUCENT | C_LIQUID));
    EXPECT_EQ(LoadShader("surfaceparm nonsolid\nsurfaceparm default").surfaceFlags, 0u);
    EXPECT_EQ(LoadShader("surfaceparm nonsolid\nsurfaceparm default").contentFlags, 1u);
    EXPECT_EQ(LoadShader("surfaceparm default\nSurfaceParm NonSolid").contentFlags, 0u);
    EXPECT_EQ(LoadShader("surfaceparm slick dust").surfaceFlags, kSlick);
    LoadShader("surfaceparm nosuchparm");
    EXPECT_EQ(Warnings("unknown surfaceparm"), 1);
}

TEST_F(ShaderDirectives, ShadersOfRavensGamesAreSolidAndOpaqueUntilAParmSaysOtherwise) {
    EXPECT_EQ(LoadShader("", "sof2").contentFlags, 0x8001u);
    const ShaderInfo &water = LoadShader("surfaceparm water", "sof2");
    EXPECT_EQ(water.contentFlags, 0x8004u);
    EXPECT_EQ(water.compileFlags, std::uint32_t(C_TRANSLUCENT | C_LIQUID));
    EXPECT_EQ(LoadShader("surfaceparm nonopaque\nsurfaceparm nonsolid", "jk2").contentFlags, 0u);
    const ShaderInfo &lit = LoadShader("q3map_onlyVertexLighting", "ja");
    EXPECT_EQ(lit.compileFlags, std::uint32_t(C_SOLID | C_VERTEXLIT));
    EXPECT_EQ(lit.surfaceFlags, 0u) << "the engine has no flag for it";
    EXPECT_EQ(LoadShader("light 1", "sof2").geometry.flareShader, "gfx/misc/lens_flare");
}

TEST_F(ShaderDirectives, Shorthands) {
    EXPECT_EQ(LoadShader("q3map_onlyVertexLighting").compileFlags, std::uint32_t(C_SOLID | C_VERTEXLIT));
    EXPECT_EQ(LoadShader("q3map_dust").surfaceFlags, kDust);
    EXPECT_EQ(LoadShader("surfaceparm slick\nq3map_material Brick", "etut").surfaceFlags, 0xC00000u | kSlick);
    EXPECT_EQ(LoadShader("q3map_material brick\nq3map_material tin", "etut").surfaceFlags, 0x100000u);
    EXPECT_EQ(LoadShader("surfaceparm slick\nq3map_material carpet\nq3map_material rock", "ja").surfaceFlags,
              0x4000u + 23u);
    LoadShader("q3map_material brick");
    EXPECT_EQ(Warnings("unknown material"), 1);
}

TEST_F(ShaderDirectives, Defaults) {
    const ShaderInfo plain = LoadShader("");
    EXPECT_TRUE(plain.defined);
    EXPECT_EQ(plain.contentFlags, 1u);
    EXPECT_EQ(plain.compileFlags, std::uint32_t(C_SOLID));
    EXPECT_FLOAT_EQ(plain.backsplashFraction, 0.05f);
    EXPECT_EQ(plain.backsplashDistance, 23);
    EXPECT_EQ(plain.bounceScale, 1);
    EXPECT_FALSE(plain.twoSided || plain.autosprite || plain.noFast || plain.forceSunlight);
    options = {.backsplashScale = 2, .backsplashDistance = 40};
    EXPECT_FLOAT_EQ(LoadShader("").backsplashFraction, 0.1f);
    EXPECT_EQ(Get("s").backsplashDistance, 40);
    EXPECT_EQ(Get("implicit").backsplashDistance, 40);
    options.backsplashDistance = -901;
    EXPECT_EQ(LoadShader("").backsplashDistance, 23);
}

TEST_F(ShaderDirectives, NumbersOfLight) {
    const ShaderInfo &s = LoadShader("Q3MAP_SurfaceLight 600.5\nq3map_lightSubdivide 100.9\nq3map_backsplash 10 "
                                     "40\nq3map_lightStyle 300\nq3map_bounceScale 1.5\n"
                                     "q3map_vertexScale 2\nq3map_vertexScale 1.5\nq3map_lightmapFilterRadius 3 "
                                     "5\nq3map_noFast\nq3map_forceSunlight");
    EXPECT_EQ(s.surfaceLight, 600.5f);
    EXPECT_EQ(s.lightSubdivide, 100);
    EXPECT_FLOAT_EQ(s.backsplashFraction, 0.1f);
    EXPECT_EQ(s.backsplashDistance, 40);
    EXPECT_EQ(s.lightStyle, 255);
    EXPECT_EQ(s.bounceScale, 1.5f);
    EXPECT_EQ(s.vertexScale, 3);
    EXPECT_EQ(s.lightmapFilterRadius, 3);
    EXPECT_EQ(s.lightFilterRadius, 5);
    EXPECT_TRUE(s.noFast && s.forceSunlight);
    EXPECT_EQ(LoadShader("q3map_lightStyle -4").lightStyle, 0);
}

TEST_F(ShaderDirectives, AbsurdNumbersStayFinite) {
    const ShaderInfo &s = LoadShader(
        "q3map_surfacelight 1e300\nq3map_bounce nan\nq3map_backsplash inf -1e99\nq3map_lightRGB -1 -2 1e-300\n"
        "q3map_sunExt 1e300 0 -1e300 1e300 1e300 -1e300 1e300 2000000000\nq3map_skyLight 1e99 2000000000");
    EXPECT_TRUE(std::isfinite(s.surfaceLight) && std::isfinite(s.bounceScale) && std::isfinite(s.backsplashFraction));
    EXPECT_TRUE(IsFinite(s.color));
    ASSERT_EQ(s.suns.size(), 1u);
    EXPECT_TRUE(IsFinite(s.suns[0].direction) && IsFinite(s.suns[0].color) && std::isfinite(s.suns[0].photons));
    ASSERT_EQ(s.skyLights.size(), 1u);
    EXPECT_LE(s.skyLights[0].iterations, 1000);
}

TEST_F(ShaderDirectives, CullAndAutosprite) {
    for (const auto *side : {"none", "Disable", "TWOSIDED"})
        EXPECT_TRUE(LoadShader(fmt::format("cull {}", side)).twoSided) << side;
    EXPECT_FALSE(LoadShader("cull back").twoSided);
    EXPECT_TRUE(LoadShader("deformVertexes AutoSprite").autosprite);
    EXPECT_TRUE(LoadShader("deformvertexes autosprite2").autosprite);
    EXPECT_FALSE(LoadShader("deformVertexes move 0 0 1 sin 0 1 0 1").autosprite);
}

TEST_F(ShaderDirectives, SunPointsFromAzimuthAndElevation) {
    const ShaderInfo &s = LoadShader(
        "q3map_sun 1 1 1 100 0 0\nq3map_sun 1 1 1 100 90 0\nq3map_sun 1 1 1 -50 45 30\nq3map_sun 1 1 1 100 10 90");
    ASSERT_EQ(s.suns.size(), 4u);
    const Vec3f expected[] = {{1, 0, 0}, {0, 1, 0}, {0.612372f, 0.612372f, 0.5f}, {0, 0, 1}};
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_LT(Length(s.suns[i].direction - expected[i]), 1e-5f) << i;
    EXPECT_EQ(s.suns[2].photons, -50);
    EXPECT_EQ(s.suns[0].samples, 1);
    EXPECT_EQ(s.suns[0].deviance, 0);
    EXPECT_EQ(s.compileFlags & C_SKY, std::uint32_t(C_SKY));
    EXPECT_EQ(s.surfaceFlags, 4u);
}

TEST_F(ShaderDirectives, SunColorIsNormalised) {
    const ShaderInfo &s = LoadShader("sun 100 50 25 1 0 0\nq3map_sun 0 0 0 1 0 0");
    EXPECT_EQ(s.suns.at(0).color, (Vec3f{1, 0.5f, 0.25f}));
    EXPECT_EQ(s.suns.at(1).color, (Vec3f{1, 1, 1}));
    options.sRgbColor = true;
    const Vec3f linear = LoadShader("q3map_sun 0.5 1 0 1 0 0").suns.at(0).color;
    EXPECT_NEAR(linear.x, 0.214041, 1e-5);
    EXPECT_EQ(linear.y, 1);
}

TEST_F(ShaderDirectives, SunTakesStyleAndRadiusAsSetSoFar) {
    const ShaderInfo &s = LoadShader("q3map_sun 1 1 1 1 0 0\nq3map_lightStyle 3\nq3map_lightmapFilterRadius 1 "
                                     "7\nq3map_sunExt 1 1 1 1 0 0 90 16\nq3map_sunExt 1 1 1 1 0 0");
    ASSERT_EQ(s.suns.size(), 3u);
    EXPECT_EQ(s.suns[0].style, 0);
    EXPECT_EQ(s.suns[0].filterRadius, 0);
    EXPECT_EQ(s.suns[1].style, 3);
    EXPECT_EQ(s.suns[1].filterRadius, 7);
    EXPECT_NEAR(s.suns[1].deviance, 1.570796, 1e-6);
    EXPECT_EQ(s.suns[1].samples, 16);
    EXPECT_EQ(s.suns[2].deviance, 0);
}

TEST_F(ShaderDirectives, LinesBelowTheSunThatNothingUsesAreWarnings) {
    const auto late = [&](std::string_view body) {
        out.log.FlushWarnings();
        out.text.clear();
        LoadShader(body);
        return out.text.find("has no effect on the sun above it") != std::string::npos;
    };
    constexpr std::string_view kSun = "q3map_sunExt 1 1 1 100 0 60 1 8\n";
    EXPECT_TRUE(late(fmt::format("{}q3map_lightmapFilterRadius 0 64", kSun)));
    EXPECT_THAT(out.text, HasSubstr("scripts/test.shader:4: shader s: q3map_lightmapFilterRadius"));
    EXPECT_TRUE(late(fmt::format("{}q3map_lightStyle 3", kSun)));
    EXPECT_FALSE(late(fmt::format("q3map_lightmapFilterRadius 0 64\n{}", kSun)));
    EXPECT_FALSE(late(fmt::format("{}q3map_lightmapFilterRadius 0 64\nq3map_skyLight 60 3", kSun)));
    EXPECT_FALSE(late(fmt::format("q3map_skyLight 60 3\n{}q3map_lightStyle 3", kSun))) << "sky light takes any line";
    EXPECT_FALSE(late(fmt::format("{}q3map_lightStyle 3\n{}", kSun, kSun))) << "the second sun takes it";
    EXPECT_FALSE(late(fmt::format("{}q3map_lightStyle 3\nq3map_surfaceLight 10", kSun)));
    EXPECT_FALSE(late(fmt::format("{}q3map_lightmapFilterRadius 8 0", kSun))) << "for its own lightmaps";
}

TEST_F(ShaderDirectives, SunLeavesTheRestOfItsLine) {
    const ShaderInfo &s = LoadShader("q3map_sun 1 1 1 100 0 0 surfaceparm slick");
    EXPECT_EQ(s.surfaceFlags, 4u | kSlick);
}

TEST_F(ShaderDirectives, SkyLight) {
    const ShaderInfo &s = LoadShader("q3map_skyLight -5 1\nq3map_skyLight 120 4 -200 70 0\nq3map_skyLight 90 3 10 20");
    ASSERT_EQ(s.skyLights.size(), 3u);
    EXPECT_EQ(s.skyLights[0].value, 0);
    EXPECT_EQ(s.skyLights[0].iterations, 2);
    EXPECT_EQ(s.skyLights[0].horizonMin, 0);
    EXPECT_EQ(s.skyLights[0].horizonMax, 90);
    EXPECT_TRUE(s.skyLights[0].sampleColor);
    EXPECT_EQ(s.skyLights[1].value, 120);
    EXPECT_EQ(s.skyLights[1].iterations, 4);
    EXPECT_EQ(s.skyLights[1].horizonMin, -90);
    EXPECT_EQ(s.skyLights[1].horizonMax, 70);
    EXPECT_FALSE(s.skyLights[1].sampleColor);
    EXPECT_EQ(s.skyLights[2].horizonMin, 10);
    EXPECT_TRUE(s.skyLights[2].sampleColor);
    EXPECT_EQ(s.compileFlags & C_SKY, std::uint32_t(C_SKY));
}

TEST_F(ShaderDirectives, BaseShaderCopiesAnEarlierDefinitionOverAllSoFar) {
    LoadScript("base\n{\nsurfaceparm slick\nq3map_surfacelight 100\nq3map_bounce 4\n}\n"
               "new\n{\nsurfaceparm dust\nq3map_baseShader BASE\nq3map_bounce 2\n}\n"
               "early\n{\nsurfaceparm dust\nq3map_baseShader late\n}\n"
               "late\n{\nsurfaceparm metalsteps\n}\n");
    EXPECT_EQ(Get("new").name, "new");
    EXPECT_EQ(Get("new").surfaceFlags, kSlick);
    EXPECT_EQ(Get("new").surfaceLight, 100);
    EXPECT_EQ(Get("new").bounceScale, 2);
    EXPECT_EQ(Get("base").bounceScale, 4);
    EXPECT_EQ(Get("early").surfaceFlags, 0u);
    EXPECT_EQ(Get("late").surfaceFlags, kMetal);
    EXPECT_EQ(Warnings("shader directive"), 2);
    EXPECT_THAT(out.text,
                HasSubstr("scripts/test.shader:10: shader new: q3map_baseShader: replaces the line above it"));
}

TEST_F(ShaderDirectives, CopiesOfCopiesCannotGrowWithoutEnd) {
    std::string script = "s0\n{\nq3map_sun 1 1 1 1 0 0\n}\n";
    for (int i = 1; i < 2000; ++i)
        script += fmt::format("s{}\n{{\nq3map_baseShader s{}\nq3map_sun 1 1 1 1 0 0\n}}\n", i, i - 1);
    LoadScript(script);
    EXPECT_EQ(Get("s9").suns.size(), 10u);
    EXPECT_LE(Get("s1999").suns.size(), 256u);
    EXPECT_GT(Warnings("too many suns"), 0);
}

TEST_F(ShaderDirectives, DeprecatedShaderIsReplacedAtLookUp) {
    LoadScript("old\n{\nq3map_deprecateShader middle.tga\n}\nmiddle\n{\nq3map_deprecateShader "
               "new\n}\nnew\n{\nsurfaceparm slick\n}\n"
               "gone\n{\nq3map_deprecateShader textures/only/image\n}\nround\n{\nq3map_deprecateShader round\n}\n");
    EXPECT_EQ(&Get("old"), &Get("new"));
    EXPECT_EQ(Get("old").surfaceFlags, kSlick);
    EXPECT_EQ(Get("gone").name, "textures/only/image");
    EXPECT_FALSE(Get("gone").defined);
    EXPECT_EQ(Get("round").name, "round");
    EXPECT_EQ(Warnings("shader replacement"), 1);
}

} // namespace
} // namespace q3
