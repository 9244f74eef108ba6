// GPL-2.0-or-later. Light stage: keys and maps that make no sense. Nothing may crash, hang or leave a number that is
// not finite.
#include "common/error.h"
#include "tests/support/light_fixture.h"

#include <cmath>
#include <limits>

namespace q3::test {

namespace {

struct Key {
    const char *key, *value;
};

Entity LightWith(std::initializer_list<Key> keys) {
    Entity light = MakeEntity("light", {{"origin", "10 20 100"}, {"light", "100"}});
    for (const Key &key : keys)
        light.Set(key.key, key.value);
    return light;
}

class RobustTest : public LightTest {
  protected:
    /// Every number finite and no mean negative.
    void ExpectSane(const Bsp &bsp) {
        const GridView grid(bsp);
        for (std::size_t i = 0; i < grid.Count(); i++) {
            const Coefficients c = grid.At(i);
            ASSERT_TRUE(AllFinite(c)) << i;
            ASSERT_GE(std::min(c[0].x, std::min(c[0].y, c[0].z)), 0) << i;
        }
        ValidateBsp(bsp, "lit", quiet_.log);
        WriteBsp(bsp, {});
    }
    Bsp LitWith(std::initializer_list<Key> keys) {
        SceneBuilder scene = Room();
        scene.AddEntity(LightWith(keys));
        scene.AddEntity(MakeEntity("info_null", {{"origin", "10 20 100"}, {"targetname", "same"}}));
        return Lit(scene, "-gridsh 64 64 64");
    }
    std::string ErrorOfLit(const SceneBuilder &scene, std::string_view options = "") {
        try {
            Lit(scene, options);
        } catch (const Error &error) {
            return error.what();
        }
        return "no error";
    }
    KeptLog quiet_;
};

struct KeyCase {
    const char *name;
    std::vector<Key> keys;
};
std::ostream &operator<<(std::ostream &out, const KeyCase &of) {
    return out << of.name;
}

class AbsurdKeyTest : public RobustTest, public testing::WithParamInterface<KeyCase> {};

TEST_P(AbsurdKeyTest, GivesAFiniteGrid) {
    SceneBuilder scene = Room();
    Entity light = LightWith({});
    light.Set("targetname", "self");
    for (const Key &key : GetParam().keys)
        light.Set(key.key, key.value);
    scene.AddEntity(light);
    scene.AddEntity(MakeEntity("info_null", {{"origin", "10 20 100"}, {"targetname", "same"}}));
    scene.AddEntity(MakeEntity("info_null", {{"targetname", "nowhere"}}));
    for (const std::string_view options :
         {"-gridsh 64 64 64", "-gridsh 64 64 64 -fast", "-gridsh 64 64 64 -wolf -noskip"})
        ExpectSane(Lit(scene, options));
}

const KeyCase kKeyCases[] = {
    {"LightNan", {{"light", "nan"}}},
    {"LightInfinite", {{"light", "inf"}}},
    {"LightHuge", {{"light", "1e38"}}},
    {"LightHugeNegative", {{"light", "-1e38"}}},
    {"LightTiny", {{"light", "1e-40"}}},
    {"LightText", {{"light", "abc"}}},
    {"LightEmpty", {{"light", ""}}},
    {"ScaleHuge", {{"scale", "1e38"}, {"light", "1e38"}}},
    {"OriginMissing", {{"origin", ""}}},
    {"OriginHuge", {{"origin", "1e30 -1e30 1e38"}}},
    {"OriginNan", {{"origin", "nan nan nan"}}},
    {"OriginOfTwo", {{"origin", "1 2"}}},
    {"OriginInAWall", {{"origin", "252 0 100"}}},
    {"ColorBlack", {{"_color", "0 0 0"}}},
    {"ColorNegative", {{"_color", "-1 -2 -3"}}},
    {"ColorNegativeRaw", {{"_color", "-1 -2 -3"}, {"spawnflags", "32"}}},
    {"ColorHuge", {{"_color", "1e38 1 1"}}},
    {"ColorHugeRaw", {{"_color", "1e38 1e38 1e38"}, {"spawnflags", "32"}}},
    {"ColorTinyOfNegatives", {{"_color", "1e-30 -1e30 0"}}},
    {"ColorNan", {{"_color", "nan 1 1"}}},
    {"FadeZero", {{"spawnflags", "1"}, {"fade", "0"}}},
    {"FadeNegative", {{"spawnflags", "1"}, {"fade", "-3"}}},
    {"FadeNan", {{"spawnflags", "1"}, {"fade", "nan"}}},
    {"FadeTiny", {{"spawnflags", "1"}, {"fade", "1e-38"}}},
    {"FadeHuge", {{"spawnflags", "1"}, {"fade", "1e38"}}},
    {"SamplesMany", {{"_samples", "1e9"}, {"_deviance", "5"}}},
    {"SamplesNegative", {{"_samples", "-5"}}},
    {"DevianceNan", {{"_samples", "4"}, {"_deviance", "nan"}}},
    {"DevianceHuge", {{"_samples", "4"}, {"_deviance", "1e38"}}},
    {"ExtraDistanceHuge", {{"_extradist", "1e38"}}},
    {"ExtraDistanceNegative", {{"_extradist", "-5"}}},
    {"TargetSelf", {{"target", "self"}}},
    {"TargetAtTheSamePlace", {{"target", "same"}}},
    {"TargetMissing", {{"target", "gone"}}},
    {"TargetWithoutOrigin", {{"target", "nowhere"}}},
    {"SunAtItsTarget", {{"target", "same"}, {"_sun", "1"}, {"_samples", "3"}, {"_deviance", "1e30"}}},
    {"SunHuge", {{"target", "nowhere"}, {"_sun", "1"}, {"light", "1e38"}}},
    {"RadiusZero", {{"target", "nowhere"}, {"radius", "0"}}},
    {"RadiusNegative", {{"target", "nowhere"}, {"radius", "-500"}}},
    {"RadiusHuge", {{"target", "nowhere"}, {"radius", "1e38"}}},
    {"SpawnflagsText", {{"spawnflags", "x"}}},
    {"SpawnflagsHuge", {{"spawnflags", "99999999999999999999"}}},
};
INSTANTIATE_TEST_SUITE_P(Keys, AbsurdKeyTest, testing::ValuesIn(kKeyCases),
                         [](const auto &of) { return of.param.name; });

TEST_F(RobustTest, AbsurdIntensitiesAndColorsAreNamed) {
    ExpectSane(LitWith({{"light", "1e38"}}));
    EXPECT_TRUE(Printed("WARNING: entity 1 (light): _light \"1e38\": expected a number from -1000000000 to 1000000000; "
                        "1000000000 is used"))
        << printed;
    ExpectSane(LitWith({{"_color", "1e38 1e38 1e38"}, {"spawnflags", "32"}}));
    EXPECT_TRUE(Printed("WARNING: light at \"10 20 100\": _color")) << printed;
    ExpectSane(LitWith({{"origin", "1e30 0 0"}}));
    EXPECT_TRUE(Printed("WARNING: light at \"1e30 0 0\" is outside any map")) << printed;
    ExpectSane(LitWith({{"target", "gone"}}));
    EXPECT_TRUE(Printed("WARNING: light at \"10 20 100\": target \"gone\"")) << printed;
    ExpectSane(LitWith({{"_sun", "1"}}));
    EXPECT_TRUE(Printed("WARNING: light at \"10 20 100\": _sun has no effect without a target")) << printed;
}

TEST_F(RobustTest, KeysOfOtherCompilersSayWhatToWriteInstead) {
    LitWith({{"mangle", "0 -90 0"}, {"delay", "2"}, {"wait", "2"}});
    EXPECT_TRUE(Printed("entity 1 (light): the key mangle \"0 -90 0\" has no effect. Use a target"))
        << printed;
    EXPECT_FALSE(Printed("wait")) << "that one is read";
}

TEST_F(RobustTest, GarbageIntensityIsTheDefault) {
    for (const char *value : {"0", "abc", ""}) {
        const GridView grid(LitWith({{"light", value}}));
        ExpectPoints(grid, kExact, 20, [](const Vec3d &p, Coefficients &c) {
            c = FromPoint(p, {10, 20, 100}, 300);
            return Inside(p, RoomBounds());
        });
    }
}

TEST_F(RobustTest, StylesOutOfRangeAreTheNearest) {
    for (const auto &[style, used] : {std::pair("255", "254"), {"-1", "0"}, {"999", "254"}}) {
        ExpectSane(LitWith({{"style", style}}));
        EXPECT_TRUE(Printed(fmt::format("_style \"{}\": expected a number from 0 to 254; {} is used", style, used)));
    }
}

TEST_F(RobustTest, MapWithoutLightsIsBlackAndSaysSo) {
    const Bsp bsp = Lit(Room());
    EXPECT_TRUE(Printed("no light entities"));
    ExpectSane(bsp);
    const GridView grid(bsp);
    for (std::size_t i = 0; i < grid.Count(); i++)
        EXPECT_EQ(Largest(grid.At(i)), 0);
}

TEST_F(RobustTest, MapWithoutOpenLeafsIsZero) {
    SceneBuilder scene = Room();
    scene.SetWorldKey("_ambient", "50");
    scene.AddEntity(LightWith({}));
    Bsp bsp = scene.Build();
    for (bspLeaf_t &leaf : bsp.leafs)
        leaf.cluster = -1;
    const Bsp lit = Lit(bsp);
    ExpectSane(lit);
    const GridView grid(lit);
    EXPECT_GT(grid.Count(), 100u);
    for (std::size_t i = 0; i < grid.Count(); i++)
        ASSERT_EQ(Largest(grid.At(i)), 0);
}

TEST_F(RobustTest, MapWithoutTreeOrSurfaces) {
    SceneBuilder scene = Room();
    scene.AddEntity(LightWith({}));
    Bsp bsp = scene.Build();
    bsp.drawSurfaces.clear(), bsp.drawVerts.clear(), bsp.drawIndexes.clear(), bsp.leafSurfaces.clear();
    for (bspModel_t &model : bsp.models)
        model.firstBSPSurface = model.numBSPSurfaces = 0;
    for (bspLeaf_t &leaf : bsp.leafs)
        leaf.firstBSPLeafSurface = leaf.numBSPLeafSurfaces = 0;
    ExpectSane(Lit(bsp, "-gridsh 64 64 64"));
    EXPECT_GT(result.gridSH.open, 0);
}

TEST_F(RobustTest, GridOfOneLayer) {
    // The only multiple of 64 between -16 and 56 is 0, in the floor.
    SceneBuilder scene = Room({-250, -186, 0}, {250, 186, 40});
    scene.AddEntity(LightWith({{"origin", "0 0 20"}}));
    const Bsp bsp = Lit(scene);
    EXPECT_EQ(GridView(bsp).Grid().header.gridBounds[2], 1);
    ExpectSane(bsp);
    // A room thinner than a cell that holds no multiple of it still has a point.
    SceneBuilder thin = Room({20, 20, 20}, {40, 40, 40});
    thin.AddEntity(LightWith({{"origin", "30 30 30"}}));
    const Bsp one = Lit(thin, "-gridsh 512 512 512");
    EXPECT_EQ(GridView(one).Count(), 1u);
    ExpectSane(one);
}

TEST_F(RobustTest, CellSizesThatMakeNoSense) {
    const SceneBuilder scene = Room();
    for (const std::string_view options : {"-gridscalesh 0", "-gridscalesh nan", "-gridscalesh -2", "-gridscalesh x",
                                           "-gridsh 0 32 32", "-gridsh 32 -1 32", "-gridsh 32 32 nan"}) {
        const std::string text = ErrorOfLit(scene, options);
        EXPECT_NE(text.find(std::string(options.substr(0, options.find(' ')))), std::string::npos) << text;
    }
    EXPECT_NE(ErrorOfLit(scene, "-gridsh 32 32"), "no error");
    EXPECT_EQ(GridView(Lit(scene, "-gridsh 0.001 64 1e6")).Grid().header.gridSize[0], 8);
    for (const char *size :
         {"", "x y z", "64", "0 0 0", "-64 -64 -128", "nan nan nan", "1e38 1e38 1e38", "1e-38 1 1"}) {
        SceneBuilder sized = Room();
        sized.SetWorldKey("gridsize", size);
        sized.AddEntity(LightWith({}));
        ExpectSane(Lit(sized));
    }
}

TEST_F(RobustTest, WorldKeysThatMakeNoSense) {
    for (const char *value : {"nan", "inf", "1e38", "-1e38", "x"}) {
        SCOPED_TRACE(value);
        SceneBuilder scene = Room();
        for (const char *key : {"_ambient", "_minlight", "_mingridlight", "_maxlight", "_floodlight"})
            scene.SetWorldKey(key, value);
        scene.SetWorldKey("_color", fmt::format("{0} {0} {0}", value));
        scene.AddEntity(LightWith({}));
        ExpectSane(Lit(scene, "-gridsh 100 100 100"));
    }
    SceneBuilder scene = Room();
    scene.SetWorldKey("_floodlight", "1e38 -1e38 nan 1e38 1e38");
    ExpectSane(Lit(scene, "-gridsh 100 100 100"));
}

TEST_F(RobustTest, DegenerateSurfaces) {
    Script("textures/test/hot\n{\n\tq3map_surfacelight 1e30\n\t{\n\t\tmap $whiteimage\n\t}\n}\n"
           "textures/test/odd\n{\n\tq3map_surfacelight nan\n\tq3map_lightSubdivide 0.0001\n\tcull none\n"
           "\t{\n\t\tmap $whiteimage\n\t}\n}\n");
    SceneBuilder scene = Room();
    scene.AddEntity(LightWith({}));
    const std::array<std::int32_t, 9> indexes = {0, 1, 2, 0, 0, 1, 3, 3, 3};
    for (const char *shader : {"textures/vec/lite", "textures/test/hot", "textures/test/odd", "textures/test/wall"}) {
        // A line, a point and a needle.
        scene.AddTriangles(std::array<Vec3f, 4>{Vec3f{0, 0, 50}, {10, 0, 50}, {20, 0, 50}, {5, 5, 60}}, indexes,
                           TestShader(shader));
        scene.AddQuad({{{0, 0, 90}, {0, 0, 90}, {0, 0, 90}, {0, 0, 90}}}, TestShader(shader));
        scene.AddQuad({{{0, 0, 90}, {100, 0, 90}, {100, 1e-5f, 90}, {0, 1e-5f, 90}}}, TestShader(shader));
        scene.AddPatch(3, 3, std::vector<Vec3f>(9, Vec3f{50, 50, 50}), TestShader(shader));
    }
    ExpectSane(Lit(scene, "-gridsh 64 64 64"));
    ExpectSane(Lit(scene, "-gridsh 64 64 64 -patchshadows -fast"));
}

TEST_F(RobustTest, SubdivisionIsBounded) {
    Script("textures/test/fine\n{\n\tq3map_surfacelight 100\n\tq3map_lightSubdivide 1e-6\n\t{\n\t\tmap "
           "$whiteimage\n\t}\n}\n");
    SceneBuilder scene = Room({0, 0, 0}, {64, 64, 64});
    scene.AddQuad({{{10, 10, 60}, {26, 10, 60}, {26, 26, 60}, {10, 26, 60}}}, TestShader("textures/test/fine"));
    ExpectSane(Lit(scene, "-gridsh 32 32 32"));
}

TEST_F(RobustTest, OptionsThatMakeNoSense) {
    SceneBuilder scene = Room();
    scene.SetWallShader(BoxFace::PlusZ, TestShader("textures/vec/sky_ext"));
    scene.SetWallShader(BoxFace::MinusX, TestShader("textures/vec/lite"));
    scene.AddEntity(LightWith({}));
    for (const std::string_view options : {"-scale nan",
                                           "-scale -1",
                                           "-scale 1e38",
                                           "-scale 0",
                                           "-gridscale nan",
                                           "-gridscale -1",
                                           "-gridscale 1e38",
                                           "-gridambientscale 1e38",
                                           "-griddirectionality nan",
                                           "-gridambientdirectionality 1e38",
                                           "-extradist 1e38",
                                           "-backsplash nan nan",
                                           "-backsplash 1e38 1e38",
                                           "-gamma 0",
                                           "-gamma nan",
                                           "-gamma 1e38",
                                           "-exposure nan",
                                           "-exposure -1",
                                           "-exposure 1e-38",
                                           "-compensate 0",
                                           "-compensate nan",
                                           "-saturation 1e38",
                                           "-contrast 1e38",
                                           "-contrast nan",
                                           "-point 1e38",
                                           "-area 1e38",
                                           "-sky 1e38",
                                           "-sky -1",
                                           "-area -1"}) {
        SCOPED_TRACE(options);
        try {
            ExpectSane(Lit(scene, std::string(options) + " -gridsh 100 100 100"));
        } catch (const Error &refused) {
            EXPECT_TRUE(std::string_view(refused.what()).starts_with(options.substr(0, options.find(' '))))
                << refused.what();
        }
    }
}

TEST_F(RobustTest, VisibilityThatHidesEverythingHidesTheLight) {
    SceneBuilder scene = Room();
    scene.AddBox({0, -186, 4}, {10, 100, 252}, TestShader("textures/test/wall"));
    scene.AddEntity(LightWith({{"origin", "100 0 100"}}));
    // Through the gap beyond y = 100.
    scene.SetVisibility({.writeLump = true});
    EXPECT_GT(Largest(LitGrid(scene).Sample({-32, 160, 128})), 0);
    scene.SetVisibility({.writeLump = true, .sees = [](const Boundsf &, const Boundsf &) { return false; }});
    EXPECT_EQ(Largest(LitGrid(scene).Sample({-32, 160, 128})), 0);
}

} // namespace

} // namespace q3::test
