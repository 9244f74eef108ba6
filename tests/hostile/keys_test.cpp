// GPL-2.0-or-later. Every numeric key of lights and of the world, with every kind of absurd number.
#include "tests/hostile/stress_fixture.h"

namespace q3::test {

namespace {

const char *const kNumbers[] = {"0",     "-0",  "1e-30", "-1e-30", "1e-45", "1e30", "-1e30", "1e38", "-1e38",
                                "1e300", "nan", "-nan",  "inf",    "-inf",  "-1",   "65536", "",     "0x7fffffff"};

/// Small, because there are thousands of bakes.
SceneBuilder SmallRoom() {
    return Room({-64, -64, 0}, {64, 64, 128});
}

enum class LightKind { Point, Linear, Spot, Sun };

/// Entities of a light of that kind with one key set to something.
void AddLight(SceneBuilder &scene, LightKind kind, std::string_view key, std::string_view value) {
    Entity light = PointLight("10 20 100");
    if (kind == LightKind::Linear)
        light.Set("spawnflags", "1");
    if (kind == LightKind::Spot || kind == LightKind::Sun) {
        light.Set("target", "aim");
        scene.AddEntity(MakeEntity("info_null", {{"origin", "60 70 10"}, {"targetname", "aim"}}));
    }
    if (kind == LightKind::Sun)
        light.Set("_sun", "1");
    if (key == "_deviance")
        light.Set("_samples", "4");
    light.Set(key, value);
    scene.AddEntity(light);
}

class LightKeys : public StressTest, public testing::WithParamInterface<const char *> {};

TEST_P(LightKeys, AnyNumber) {
    const std::string_view key = GetParam();
    const bool isVector = key == "_color" || key == "origin";
    for (const LightKind kind : {LightKind::Point, LightKind::Linear, LightKind::Spot, LightKind::Sun})
        for (const char *number : kNumbers) {
            SCOPED_TRACE(fmt::format("kind {}: {}", int(kind), number));
            SceneBuilder scene = SmallRoom();
            scene.SetWallShader(BoxFace::PlusZ, TestShader("textures/vec/sky_sun"));
            AddLight(scene, kind, key, isVector ? fmt::format("{0} 1 {0}", number) : number);
            std::string_view options = kind == LightKind::Point ? kBothGrids : kUniformGrid;
            if (key == "_samples") // up to 65536 rays for each point
                options = "-gridsh 256 256 256";
            LitSoundlyOrRefused(scene, options, "light at");
        }
}

INSTANTIATE_TEST_SUITE_P(Stress, LightKeys,
                         testing::Values("light", "_light", "scale", "_color", "origin", "fade", "radius", "angle",
                                         "_extradist", "_samples", "_deviance", "spawnflags", "style", "_sun"),
                         [](const auto &of) { return std::string(of.param); });

class WorldKeys : public StressTest, public testing::WithParamInterface<const char *> {};

TEST_P(WorldKeys, AnyNumber) {
    const std::string_view key = GetParam();
    for (const char *number : kNumbers) {
        SCOPED_TRACE(number);
        for (const std::string &value : {std::string(number), fmt::format("{0} {0} {0} {0} {0}", number)}) {
            SceneBuilder scene = SmallRoom();
            scene.SetWorldKey(key, value);
            if (key == "_color")
                scene.SetWorldKey("_ambient", "10");
            scene.AddEntity(PointLight("10 20 100"));
            LitSoundlyOrRefused(scene, kBothGrids, "grid"); // only a grid may be refused
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Stress, WorldKeys,
                         testing::Values("gridsize", "_mingridlight", "_minlight", "_ambient", "ambient", "_color",
                                         "_maxlight", "_floodlight", "_noshadersun", "_keepLights"),
                         [](const auto &of) { return std::string(of.param); });

class ShaderNumbers : public StressTest, public testing::WithParamInterface<const char *> {};

TEST_P(ShaderNumbers, AnyNumber) {
    const std::string_view directive = GetParam();
    int count = 0;
    for (const char *number : kNumbers) {
        std::string line(directive);
        for (std::size_t at = 0; (at = line.find('#', at)) != std::string::npos;)
            line.replace(at, 1, *number == 0 ? "x" : number);
        LampShader(fmt::format("textures/test/odd{}", count++), 400, line);
    }
    for (int i = 0; i < count; i++) {
        SCOPED_TRACE(kNumbers[i]);
        SceneBuilder scene = SmallRoom();
        scene.SetWallShader(BoxFace::PlusZ, TestShader(fmt::format("textures/test/odd{}", i)));
        LitSoundly(scene, kBothGrids);
    }
}

INSTANTIATE_TEST_SUITE_P(
    Stress, ShaderNumbers,
    testing::Values("q3map_surfacelight #", "q3map_lightRGB # # #", "q3map_lightRGB 1 # 0", "q3map_lightSubdivide #",
                    "q3map_backsplash # #", "q3map_backsplash 5 #", "surfaceparm sky\n\tq3map_sun # # # # # #",
                    "surfaceparm sky\n\tq3map_sun 1 1 1 # 30 60", "surfaceparm sky\n\tq3map_sunExt 1 1 1 100 30 60 # #",
                    "surfaceparm sky\n\tq3map_sunExt 1 1 1 100 30 60 # 3", "surfaceparm sky\n\tq3map_skyLight # 3",
                    "surfaceparm sky\n\tq3map_skyLight 100 3 # #"),
    [](const auto &of) { return fmt::format("Directive{}", of.index); });

TEST_F(StressTest, AbsurdLightsDoNotSpoilOthers) {
    // A NaN that got into a sum would stay there.
    SceneBuilder scene = Room();
    for (const char *key : {"light", "scale", "_extradist", "fade"})
        for (const char *number : {"nan", "inf", "-inf", "1e-45"}) {
            Entity light = PointLight("10 20 100");
            light.Set(key, number);
            if (std::string_view(key) == "fade")
                light.Set("spawnflags", "1");
            scene.AddEntity(light);
        }
    scene.AddEntity(PointLight("-100 -100 60", "1000"));
    const GridView grid(LitSoundly(scene, kBothGrids));
    for (std::size_t i = 0; i < grid.Count(); i++) {
        const Vec3d p = grid.Position(i);
        if (Inside(p, RoomBounds())) {
            ASSERT_GE(grid.At(i)[0].x, 0.999 * FromPoint(p, {-100, -100, 60}, 1000)[0].x);
        }
    }
}

} // namespace

} // namespace q3::test
