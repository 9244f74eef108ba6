// GPL-2.0-or-later. Directives that shape surfaces, and sizes of images.
#include "common/error.h"
#include "tests/support/library_fixture.h"

#include <gmock/gmock.h>

namespace q3 {

namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using ShaderGeometry = test::LibraryTest;

TEST_F(ShaderGeometry, DefaultsAreOff) {
    const GeometryDirectives &g = LoadShader("").geometry;
    EXPECT_EQ(g.tessSize, 0);
    EXPECT_FALSE(g.forceMeta || g.nonPlanar || g.indexed || g.hasTexGen || g.hasFogParms || g.fogDir || g.move);
    EXPECT_THAT(g.texMod[0], ElementsAre(1, 0, 0));
    EXPECT_THAT(g.texMod[1], ElementsAre(0, 1, 0));
}

TEST_F(ShaderGeometry, VectorsMayStandInParentheses) {
    const GeometryDirectives &g = LoadShader("q3map_tcGen ivector ( 256 0 0 ) ( 0 -128 0 )\n"
                                             "q3map_fogDir ( 0 0 -4 )")
                                      .geometry;
    ASSERT_TRUE(g.hasTexGen && g.fogDir);
    EXPECT_EQ(g.texGen[0], (Vec3f{1.0f / 256, 0, 0}));
    EXPECT_EQ(g.texGen[1], (Vec3f{0, -1.0f / 128, 0}));
    EXPECT_EQ(*g.fogDir, (Vec3f{0, 0, -1}));
}

TEST_F(ShaderGeometry, TextureStepsCombine) {
    const GeometryDirectives &g = LoadShader("q3map_tcMod translate 3 4\nq3map_tcMod scale 2 5").geometry;
    EXPECT_THAT(g.texMod[0], ElementsAre(2, 0, 3));
    EXPECT_THAT(g.texMod[1], ElementsAre(0, 5, 4));
    const GeometryDirectives &turned = LoadShader("q3map_tcMod rotate 90").geometry;
    EXPECT_NEAR(turned.texMod[0][1], -1, 1e-6);
    EXPECT_NEAR(turned.texMod[1][0], 1, 1e-6);
}

TEST_F(ShaderGeometry, ColorStepsKeepTheirOrder) {
    const GeometryDirectives &g =
        LoadShader(
            "q3map_alphaMod volume\nq3map_alphaMod dotProduct2scale ( 0 0 1 0.25 0.75 )\nq3map_rgbGen set ( 1 0 0.5 )")
            .geometry;
    ASSERT_EQ(g.colorSteps.size(), 3u);
    EXPECT_TRUE(g.IsColorVolume());
    EXPECT_EQ(g.colorSteps[1].kind, ColorStep::Kind::DotProduct2Scale);
    EXPECT_TRUE(g.colorSteps[1].alpha);
    EXPECT_EQ(g.colorSteps[1].max, 0.75f);
    EXPECT_EQ(g.colorSteps[2].value, (Vec3f{1, 0, 0.5f}));
}

TEST_F(ShaderGeometry, VolumeMustBeTheFirstStep) {
    EXPECT_TRUE(LoadShader("q3map_alphaMod volume\nq3map_alphaMod set 0").geometry.IsColorVolume());
    EXPECT_EQ(Warnings("shader directive"), 0);
    EXPECT_EQ(LoadShader("q3map_alphaMod set 0\nq3map_alphaMod volume").geometry.colorSteps.size(), 1u);
    EXPECT_EQ(Warnings("shader directive"), 1);
}

TEST_F(ShaderGeometry, WrongWordsAreWarningsAndChangeNothing) {
    const GeometryDirectives &g = LoadShader("q3map_tcGen spherical 1 2 3 4 5 6\nq3map_rgbMod swizzle\n"
                                             "q3map_tcMod shear 1 2\nq3map_textureSize 0 64\nq3map_fogDir ( 0 0 0 )")
                                      .geometry;
    EXPECT_FALSE(g.hasTexGen || g.fogDir || g.textureSizeGiven);
    EXPECT_TRUE(g.colorSteps.empty());
    EXPECT_EQ(Warnings("shader directive"), 5);
}

TEST_F(ShaderGeometry, SpritesAreDetail) {
    const ShaderInfo &info = LoadShader("deformVertexes autosprite2");
    EXPECT_TRUE(info.autosprite && info.geometry.autosprite2);
    EXPECT_NE(info.compileFlags & C_DETAIL, 0u);
}

TEST_F(ShaderGeometry, MovementGivesTheBoxItStaysIn) {
    const auto &move = LoadShader("deformVertexes move 0 -2 1 sin 4 8 0 1").geometry.move;
    ASSERT_TRUE(move);
    EXPECT_EQ(move->first, (Vec3f{0, -24, 4}));
    EXPECT_EQ(move->second, (Vec3f{0, -8, 12}));
}

TEST_F(ShaderGeometry, TerrainIsABundle) {
    options.imageSizes = true;
    WriteTga("s.tga", {{0, 0, 0, 255}, {0, 0, 0, 255}});
    LoadScript("s\n{\nq3map_terrain\n}\n");
    const ShaderInfo &info = library->Get("s");
    const GeometryDirectives &g = info.geometry;
    EXPECT_TRUE(g.noClip && g.noTJunctions && g.indexed && g.nonPlanar && g.forceMeta);
    EXPECT_EQ(info.lightmap.shadeAngle, 179);
    EXPECT_EQ(g.texGen[0], (Vec3f{1, 0, 0})); // 2 / width
    EXPECT_EQ(g.texGen[1], (Vec3f{0, 2, 0}));
}

TEST_F(ShaderGeometry, SizeIsOfTheEditorImageThenOfTheName) {
    options.imageSizes = true;
    WriteTga("a/shown.tga", std::vector<std::array<int, 4>>(3));
    WriteTga("s.tga", std::vector<std::array<int, 4>>(5));
    LoadScript("s\n{\nqer_editorimage a/shown.tga\n}\nt\n{\nq3map_textureSize 7 9\n}\nn\n{\nsurfaceparm nodraw\n}\n");
    EXPECT_EQ(library->Get("s").geometry.textureWidth, 3);
    EXPECT_EQ(library->Get("s").geometry.textureHeight, 1);
    EXPECT_EQ(library->Get("t").geometry.textureHeight, 9);
    EXPECT_EQ(library->Get("nowhere").geometry.textureWidth, 64);
    EXPECT_EQ(Warnings("image not found"), 2);
    EXPECT_EQ(library->Get("n").geometry.textureWidth, 64);
    EXPECT_EQ(Warnings("image not found"), 2); // what is not drawn needs none
}

TEST_F(ShaderGeometry, ImagesOfTheEngineNeedNoFile) {
    options.imageSizes = true;
    LoadScript("white\n{\n{\nmap $whiteimage\n}\n{\nmap *white\n}\n}\n"
               "both\n{\n{\nmap $lightmap\n}\n{\nmap gone.tga\n}\n}\n");
    EXPECT_EQ(library->Get("white").geometry.textureWidth, 64);
    EXPECT_EQ(Warnings("image not found"), 0);
    library->Get("both");
    EXPECT_EQ(Warnings("image not found"), 1);
}

TEST_F(ShaderGeometry, GlobalFlagsReachAllShaders) {
    options.globalFlags = {"slick"};
    options.noOb = true;
    LoadScript("a\n{\nsurfaceparm ob\n}\n");
    EXPECT_EQ(library->Get("a").surfaceFlags, 0x2u);
    EXPECT_EQ(library->Get("b").surfaceFlags, 0x80002u);
}

TEST_F(ShaderGeometry, CustomParmsWithoutTheirFileAreAWarning) {
    options.customInfoParms = true;
    EXPECT_EQ(LoadShader("surfaceparm slick").surfaceFlags, test::kSlick);
    EXPECT_EQ(Warnings("no custom surfaceparms"), 1);
}

TEST_F(ShaderGeometry, CustomParmsComeAfterTheGames) {
    options.customInfoParms = true;
    folder.Write("scripts/custinfoparms.txt", "{\nglue 0x400\n}\n{\nstick 1000000\nslick 4000000\n}\n");
    const ShaderInfo &info = LoadShader("surfaceparm glue\nsurfaceparm stick\nsurfaceparm slick");
    EXPECT_EQ(info.contentFlags, 0x401u);
    EXPECT_EQ(info.surfaceFlags, 0x1000002u);
}

TEST_F(ShaderGeometry, ADamagedFileOfCustomParmsIsAnErrorWithItsLine) {
    options.customInfoParms = true;
    const auto errorOf = [this](const std::string &text) -> std::string {
        folder.Write("scripts/custinfoparms.txt", text);
        try {
            Load();
        } catch (const Error &error) {
            return error.what();
        }
        return "no error";
    };
    EXPECT_THAT(errorOf("{\n}\nglue 0x400\n"),
                HasSubstr("custinfoparms.txt:3: expected two lists in braces, content flags and surface flags"));
    EXPECT_THAT(errorOf("{\n}\n"), HasSubstr("expected two lists in braces"));
    EXPECT_THAT(errorOf("{\nglue\n}\n{\n}\n"),
                HasSubstr("custinfoparms.txt:3: expected a hexadecimal number after glue"));
    std::string many = "{\n}\n{\n";
    for (int i = 0; i < 257; ++i)
        many += fmt::format("parm{} 0x1\n", i);
    EXPECT_THAT(errorOf(many + "}\n"), HasSubstr("custinfoparms.txt:260: more than 256 parms"));
}

} // namespace

} // namespace q3
