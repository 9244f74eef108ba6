// GPL-2.0-or-later. Texlights: what .rad files say, and the light of surfaces that have one.
#include "q3map2/light/sources/light_surfaces.h"
#include "tests/support/light_fixture.h"

#include <cmath>

namespace q3::test {

namespace {

/// Light of a color channel of byte value c with brightness I, as light keys define it.
double OfChannel(double c, double brightness = 255) {
    return std::pow(c / 255, 2.2) * brightness;
}

class RadFileTest : public testing::Test {
  protected:
    void Read(std::string_view text, std::string_view file = "lights.rad", bool hdr = false) {
        Log log([this](LogLevel, std::string_view line) { printed += line; });
        lights.Read(text, file, hdr, log);
    }
    /// Red, green and blue of a shader; negative: it has no texlight.
    Vec3f Of(std::string_view shader) const {
        const TexLight *light = lights.Find(shader);
        return light ? light->radiance : Vec3f{-1, -1, -1};
    }
    bool Printed(std::string_view text) const { return printed.find(text) != std::string::npos; }
    static void ExpectLight(const Vec3f &got, const Vec3d &wanted) {
        for (std::size_t channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(got[channel], wanted[channel], 1e-4 * wanted[channel]) << channel;
    }

    TexLights lights;
    std::string printed;
};

TEST_F(RadFileTest, LinesAreAColorAndABrightnessAsInLightKeys) {
    Read("lights/white 255 255 255\nlights/warm\t255 200 100 90\n  lights/dim 10 20 30 1000  \n");
    ExpectLight(Of("textures/lights/white"), {255, 255, 255});
    ExpectLight(Of("textures/lights/warm"), {90, OfChannel(200, 90), OfChannel(100, 90)});
    ExpectLight(Of("textures/lights/dim"), {OfChannel(10, 1000), OfChannel(20, 1000), OfChannel(30, 1000)});
    EXPECT_EQ(printed, "");
}

TEST_F(RadFileTest, NamesMatchWithoutCaseAndWithOrWithoutTextures) {
    Read("Lights/White 255 255 255 1\ntextures/LIGHTS/red 255 0 0 2\nlights\\blue 0 0 255 3\n");
    for (const std::string_view name : {"textures/lights/white", "TEXTURES/lights/WHITE", "lights/white"})
        ExpectLight(Of(name), {1, 1, 1});
    ExpectLight(Of("textures/lights/red"), {2, 0, 0});
    ExpectLight(Of("lights/red"), {2, 0, 0});
    ExpectLight(Of("textures/lights/blue"), {0, 0, 3});
    EXPECT_LT(Of("textures/lights/whit").x, 0);
    EXPECT_LT(Of("textures/lights/white2").x, 0);
    EXPECT_LT(Of("textures/textures/lights/white").x, 0);
}

TEST_F(RadFileTest, CopiesForCubeMapsAreTheirOriginals) {
    Read("lights/white 255 255 255 1\n");
    ExpectLight(Of("maps/city/lights/white_128_-64_7"), {1, 1, 1});
    EXPECT_LT(Of("maps/city/lights/white_128_-64").x, 0);
    EXPECT_LT(Of("maps/lights/white_1_2_3").x, 0);
    EXPECT_LT(Of("textures/lights/white_1_2_3").x, 0);
}

TEST_F(RadFileTest, CommentsBlankLinesAndCarriageReturns) {
    Read("// a comment\r\n\r\nlights/white 255 255 255 9 // bright\r\n   \t\r\n//lights/no 1 2 3\r\nlights/last 255 "
         "255 255 8");
    ExpectLight(Of("lights/white"), {9, 9, 9});
    ExpectLight(Of("lights/last"), {8, 8, 8});
    EXPECT_EQ(lights.All().size(), 2u);
    EXPECT_EQ(printed, "");
}

TEST_F(RadFileTest, LaterLinesOverrideWithAWarning) {
    Read("lights/white 255 255 255 1\n");
    Read("\ntextures/lights/WHITE 255 255 255 2\n", "mymap.rad");
    ExpectLight(Of("lights/white"), {2, 2, 2});
    EXPECT_TRUE(Printed("mymap.rad:2: textures/lights/WHITE: this line counts, not lights.rad:1")) << printed;
}

TEST_F(RadFileTest, LinesForHdrAndLdr) {
    constexpr std::string_view kText = "hdr:lights/a 255 255 255 1\nldr:lights/a 255 255 255 2\n"
                                       "HDR:lights/b 255 255 255 3\nldr: lights/c 255 255 255 4\n"
                                       "lights/d 255 255 255 5 255 0 0 6\nlights/e 255 255 255 7 -1 -1 -1 1\n";
    Read(kText);
    ExpectLight(Of("lights/a"), {2, 2, 2});
    EXPECT_LT(Of("lights/b").x, 0);
    ExpectLight(Of("lights/c"), {4, 4, 4});
    ExpectLight(Of("lights/d"), {5, 5, 5});
    lights = {};
    Read(kText, "lights.rad", true);
    ExpectLight(Of("lights/a"), {1, 1, 1});
    ExpectLight(Of("lights/b"), {3, 3, 3});
    EXPECT_LT(Of("lights/c").x, 0);
    ExpectLight(Of("lights/d"), {6, 0, 0});
    ExpectLight(Of("lights/e"), {7, 7, 7});
    EXPECT_EQ(printed, "");
}

TEST_F(RadFileTest, EachBadLineIsNamedAndLeftOut) {
    for (const std::string_view bad : {"lights/x", "lights/x 1 2", "lights/x 1 2 3 4 5", "lights/x 1 2 3x 4",
                                       "lights/x 1 -2 3", "lights/x 255 255 255 1e30", "lights/x nan 1 1", "noshadow",
                                       "forcetextureshadow", "lights/x 1 2 3 4 5 6 7 8 9"}) {
        printed.clear(), lights = {};
        Read(fmt::format("lights/good 255 255 255 1\n{}\nlights/also 255 255 255 1\n", bad), "some.rad");
        EXPECT_TRUE(Printed("some.rad:2")) << bad << ": " << printed;
        EXPECT_EQ(lights.All().size(), 2u) << bad;
    }
}

TEST_F(RadFileTest, More128EntriesAreFine) {
    std::string text;
    for (int i = 1; i <= 300; ++i)
        text += fmt::format("lights/n{} 255 255 255 {}\n", i, i);
    Read(text);
    ExpectLight(Of("lights/n128"), {128, 128, 128});
    ExpectLight(Of("lights/n129"), {129, 129, 129});
    ExpectLight(Of("lights/n300"), {300, 300, 300});
    EXPECT_EQ(printed, "");
}

TEST_F(RadFileTest, Shadows) {
    Read("noshadow Glass/Window.vmt\nNoShadow textures/metal/grate\n"
         "forcetextureshadow models\\Props\\Fence01.mdl\n");
    EXPECT_TRUE(lights.CastsNoShadow("textures/glass/window01"));
    EXPECT_TRUE(lights.CastsNoShadow("textures/old/glass/windowpane"));
    EXPECT_TRUE(lights.CastsNoShadow("textures/metal/grate"));
    EXPECT_FALSE(lights.CastsNoShadow("textures/glass/door"));
    EXPECT_TRUE(lights.CastsTextureShadow("models/props/fence01.mdl"));
    EXPECT_TRUE(lights.CastsTextureShadow("models/props/FENCE01"));
    EXPECT_FALSE(lights.CastsTextureShadow("models/props/fence02.mdl"));
    EXPECT_EQ(printed, "");
}

// ---- light -----------------------------------------------------------------------------------------------------

class TexLightTest : public LightTest {
  protected:
    void Rad(std::string_view text) {
        KeptLog quiet;
        texLights = {};
        texLights.Read(text, "test.rad", false, quiet.log);
    }
    /// A lamp of 64 x 64 in the middle of the ceiling that shines down from 236.
    static SceneBuilder WithLamp() {
        SceneBuilder scene = Room();
        const int box = scene.AddBox({-32, -32, 236}, {32, 32, 252}, TestShader("textures/test/wall"), BoxKind::Detail);
        scene.SetFaceShader(box, BoxFace::MinusZ, TestShader("textures/test/lamp"));
        return scene;
    }
    static Coefficients FromLamp(const Vec3d &p, const Vec3d &light) {
        return FromRectangle(p, {-32, -32, 236}, {64, 0, 0}, {0, 64, 0}, {0, 0, -1}, 1, light);
    }
};

TEST_F(TexLightTest, GridPointsGetTheFormFactorTimesTheColor) {
    Rad("test/lamp 255 200 100 500\n");
    ExpectPoints(LitGrid(WithLamp()), 1e-5, 400, [](const Vec3d &p, Coefficients &c) {
        c = FromLamp(p, {500, OfChannel(200, 500), OfChannel(100, 500)});
        return Inside(p, RoomBounds());
    });
}

TEST_F(TexLightTest, OptionAreaScalesIt) {
    Rad("test/lamp 255 255 255\n");
    ExpectPoints(LitGrid(WithLamp(), "-area 2"), 1e-5, 400, [](const Vec3d &p, Coefficients &c) {
        c = FromLamp(p, {510, 510, 510});
        return Inside(p, RoomBounds());
    });
}

TEST_F(TexLightTest, WinsOverTheShaderAndNotesIt) {
    Script("textures/test/lamp\n{\nq3map_surfaceLight 4000\nq3map_lightRGB 0 0 1\n}\n");
    Rad("test/lamp 255 0 0 300\n");
    ExpectPoints(LitGrid(WithLamp()), 1e-5, 400, [](const Vec3d &p, Coefficients &c) {
        c = FromLamp(p, {300, 0, 0});
        return Inside(p, RoomBounds());
    });
    EXPECT_TRUE(Printed("textures/test/lamp: test.rad:1 counts, not q3map_surfaceLight 4000")) << printed;
}

TEST_F(TexLightTest, BlackTurnsAShaderOff) {
    Script("textures/test/lamp\n{\nq3map_surfaceLight 4000\n}\n");
    Rad("test/lamp 0 0 0\n");
    ExpectPoints(LitGrid(WithLamp()), 1e-6, 400, [](const Vec3d &p, Coefficients &c) {
        c = {};
        return Inside(p, RoomBounds());
    });
}

/// 4/3 of the byte value is the q3map_surfaceLight that emits the same.
TEST_F(TexLightTest, IsQ3mapSurfaceLightOfFourThirds) {
    Rad("test/lamp 255 255 255 300\n");
    const GridView rad(Lit(WithLamp()));
    Rad("");
    Script("textures/test/lamp\n{\nq3map_surfaceLight 400\nq3map_lightRGB 1 1 1\nq3map_backsplash 0 0\n}\n");
    const GridView shader(Lit(WithLamp()));
    ASSERT_EQ(rad.Count(), shader.Count());
    double most = 0;
    for (std::size_t i = 0; i < rad.Count(); ++i) {
        EXPECT_LE(Difference(rad.At(i), shader.At(i)), 1e-6) << i;
        most = std::max(most, Largest(rad.At(i)));
    }
    EXPECT_GT(most, 0.3);
}

TEST_F(TexLightTest, NoShadowLetsLightThrough) {
    SceneBuilder scene = WithLamp();
    scene.AddQuad(std::array<Vec3f, 4>{{{-120, 120, 150}, {120, 120, 150}, {120, -120, 150}, {-120, -120, 150}}},
                  TestShader("textures/test/pane_a"));
    Rad("test/lamp 255 255 255 500\n");
    const GridView dark(Lit(scene.Build()));
    Rad("test/lamp 255 255 255 500\nnoshadow pane_.vmt\n");
    const GridView open(Lit(scene.Build()));
    int checked = 0;
    for (std::size_t i = 0; i < open.Count(); ++i) {
        const Vec3d p = open.Position(i);
        if (!Inside(p, RoomBounds()) || p.z > 100 || std::abs(p.x) > 70 || std::abs(p.y) > 70)
            continue;
        ++checked;
        EXPECT_LE(Difference(open.At(i), FromLamp(p, {500, 500, 500})), 1e-5);
        EXPECT_LE(Largest(dark.At(i)), 1e-3);
    }
    EXPECT_GE(checked, 8);
}

} // namespace

} // namespace q3::test
