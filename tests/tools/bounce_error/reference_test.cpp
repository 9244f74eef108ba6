// GPL-2.0-or-later. References of luxels and positions, and errors against them.
#include "q3map2/lightmap/light_stage.h"
#include "tests/tools/bounce_error/bounce_fixture.h"
#include "tools/measure/bounce_error/bounce_causes.h"
#include "tools/measure/bounce_error/lit_files.h"
#include "tools/measure/bounce_error/map_bakes.h"

#include <cmath>

namespace q3::test {

namespace {

using namespace bounce;

SceneBuilder LampRoom() {
    SceneBuilder scene;
    scene.SetInterior({-256, -256, -256}, {256, 256, 0}, {"textures/test/wall"});
    scene.SetWorldKey("_keepLights", "1");
    scene.SetWallShader(BoxFace::MinusZ, {"textures/test/bright"});
    scene.AddEntity({{{"classname", "light"}, {"origin", "50 20 -100"}, {"light", "100"}}});
    return scene;
}

TEST_F(PathTest, TheReferenceDoesNotDependOnThreadsAndIsKept) {
    Reference first;
    const std::filesystem::path cache = folder / "cache";
    for (const int threads : {1, 3}) {
        const auto scene = Make(LampRoom(), 0.5f, threads);
        scene->Prepare();
        const Receivers receivers{LuxelsByArea(scene->in, scene->surfaces, scene->tracer->Scene(), 20, 1),
                                  {{0, 0, -100}, {60, 60, -60}}};
        ASSERT_EQ(receivers.luxels.size(), 20u);
        const auto make = [&](int paths, const std::filesystem::path &in) {
            return MakeReference(scene->in, *scene->tracer, *scene->lights, receivers, paths, in);
        };
        const Reference found = make(512, {}), stored = make(512, cache), again = make(512, cache);
        if (threads == 1)
            first = found;
        EXPECT_EQ(found.luxels, first.luxels);
        EXPECT_EQ(found.positions, first.positions);
        EXPECT_EQ(stored.fromCache, threads == 3);
        EXPECT_TRUE(again.fromCache);
        EXPECT_EQ(again.luxels, first.luxels);
        EXPECT_EQ(again.positions, first.positions);
        EXPECT_FALSE(make(1024, cache).fromCache && threads == 1);
    }
    // Another reflectance is another reference.
    const auto other = Make(LampRoom(), 0.4f);
    other->Prepare();
    const Receivers receivers{LuxelsByArea(other->in, other->surfaces, other->tracer->Scene(), 20, 1),
                              {{0, 0, -100}, {60, 60, -60}}};
    EXPECT_FALSE(MakeReference(other->in, *other->tracer, *other->lights, receivers, 512, cache).fromCache);
}

TEST_F(PathTest, LuxelsAreDrawnByArea) {
    const auto scene = Make(LampRoom(), 0.5f);
    scene->Prepare();
    const auto luxels = LuxelsByArea(scene->in, scene->surfaces, scene->tracer->Scene(), 4000, 1);
    ASSERT_EQ(luxels.size(), 4000u);
    double bright = 0;
    for (const LuxelReceiver &luxel : luxels) {
        const bool floor = luxel.normal.z > 0.99f;
        bright += floor;
        if (floor) {
            EXPECT_NEAR(luxel.position.z, -255, 0.01);
        }
    }
    // Floor and ceiling have 512 x 512, the four others 512 x 256.
    EXPECT_NEAR(bright / 4000, 0.25, 4 * std::sqrt(0.25 * 0.75 / 4000));
}

/// Walls of light 40 that reflect half of it.
SceneBuilder WhiteFurnace() {
    SceneBuilder scene;
    scene.SetInterior({-128, -128, -128}, {128, 128, 128}, {"textures/test/bright"});
    scene.SetWorldKey("_ambient", "40");
    return scene;
}

TEST_F(PathTest, BakesOfAFurnaceAreRight) {
    options.bounceScale = 0.5f / (187.5f * 3 / 255);
    const VirtualFileSystem &files = Files();
    KeptLog log;
    const MeasuredMap map{files, *FindGame("quake3"), WhiteFurnace().Build(), {"test", {}, {}}, log.log};
    const MapSetup setup(map, {{}, options});
    const JobPool jobs(1);
    SurfaceLight surfaces;
    const BakedLuxels direct = BakeLuxels(setup, 0, jobs, log.log, &surfaces);
    const LightSetup &light = setup.light;
    const SurfaceInputs in{light.bsp,   light.space, light.scene, light.table, light.options, setup.settings.lightmap,
                           light.world, jobs,        log.log};
    const DirectLights lights(in, {});
    const PathTracer tracer(in, surfaces, lights);
    const Receivers receivers{LuxelsByArea(in, surfaces, tracer.Scene(), 50, 1), {{0, 0, 0}, {60, 60, -60}}};
    const Reference reference = MakeReference(in, tracer, lights, receivers, 1024, {});
    const BakedGrid directGrid = BakeGrid(map, setup.settings, 0, jobs);
    for (const int bounces : {1, 3}) {
        const std::size_t limit = LimitIndexOf(bounces);
        const auto luxels =
            CompareLuxels(receivers, reference, limit, direct, BakeLuxels(setup, bounces, jobs, log.log));
        ASSERT_EQ(luxels.size(), 50u);
        const BounceErrors errors = ErrorsOf(luxels);
        EXPECT_LT(errors.rmse, 0.3);
        EXPECT_NEAR(errors.energy, 1, 0.01);
        EXPECT_NEAR(errors.meanLight, 40 * (1 - std::pow(0.5, bounces)), 0.3);
        const BakedGrid grid = BakeGrid(map, setup.settings, bounces, jobs);
        const auto positions = ComparePositions(receivers, reference, limit, directGrid.bsp, grid.bsp);
        ASSERT_EQ(positions.size(), 52u);
        EXPECT_LT(ErrorsOf(positions).rmse, 1);
        EXPECT_NEAR(ErrorsOf(positions).energy, 1, 0.01);
    }
    // What the bake does not do shows as an error.
    EXPECT_NEAR(ErrorsOf(CompareLuxels(receivers, reference, LimitIndexOf(1), direct, direct)).rmse, 20, 0.2);
    const CauseInputs causes{in, surfaces, tracer, lights, receivers, direct};
    for (const BounceSteps &step : StepsOfFirstBounce(causes, 1024)) {
        EXPECT_NEAR(step.atTexels.x, 20, 0.05);
        EXPECT_NEAR(step.coarse.y, 20, 0.05);
        if (step.complete) {
            EXPECT_NEAR(step.window.x, 20, 0.05);
        }
    }
}

TEST_F(PathTest, LitFilesOfAFurnaceAreRight) {
    options.bounceScale = 0.5f / (187.5f * 3 / 255);
    const auto scene = Make(WhiteFurnace(), 0.5f);
    scene->Prepare();
    const auto lit = [&](int bounces) {
        Bsp bsp = scene->bsp;
        LightOptions light;
        light.noGrid = true;
        LightmapOptions own = options;
        own.bounces = bounces;
        ShaderLibrary library(Files(), *FindGame("quake3"), {}, scene->log.log);
        LightWorld(bsp, {"test", {}, {}}, light, own, library, scene->jobs, scene->log.log);
        compare::Page page{128, 128, bsp.lightmaps};
        page.rgb.resize(std::size_t(128) * 128 * 3);
        return compare::LitMap(std::move(bsp), {page}, {});
    };
    const compare::LitMap direct = lit(0), bounced = lit(1);
    const LitFiles files{direct, bounced};
    const auto points = LitPoints(scene->in, scene->tracer->Scene(), files, 60, 1);
    ASSERT_EQ(points.size(), 60u);
    const Receivers receivers = ReceiversOf(points);
    const Reference reference = MakeReference(scene->in, *scene->tracer, *scene->lights, receivers, 512, {});
    const auto light = CompareLit(points, reference, LimitIndexOf(1), files);
    ASSERT_EQ(light.size(), 60u);
    EXPECT_NEAR(light[0].direct.x, 40, 1);
    EXPECT_LT(ErrorsOf(light).rmse, 1);
    EXPECT_NEAR(ErrorsOf(light).energy, 1, 0.05);
}

TEST(BounceErrorsTest, LightIsCutAsOnAScreen) {
    std::vector<ComparedLight> light(100);
    for (ComparedLight &one : light)
        one = {{100, 250, 300}, {10, 20, 70}, {12, 1, 5}, {0.5f, 0.5f, 0.5f}};
    // Red 110 for 112, green 255 for 251, blue 255 for 255.
    const BounceErrors errors = ErrorsOf(light);
    EXPECT_EQ(errors.receivers, 100u);
    EXPECT_NEAR(errors.rmse, std::sqrt((4 + 16) / 3.0), 1e-6);
    EXPECT_NEAR(errors.bias, (-2 + 4) / 3.0, 1e-6);
    EXPECT_NEAR(errors.percentile95, 4, 1e-6);
    EXPECT_NEAR(errors.energy, 100 / 18.0, 1e-6);
    EXPECT_NEAR(errors.noise, 0.5 * std::sqrt(2 / 3.0), 1e-6);
    EXPECT_NEAR(SquaredError(light[0]), 20, 1e-6);
}

TEST(BounceErrorsTest, OptionsAreComparedWordByWord) {
    EXPECT_EQ(OptionsWithoutBounces(" -bounce 4"), "");
    EXPECT_EQ(OptionsWithoutBounces("-fast  -bounce 4 -gamma 2"), OptionsWithoutBounces("-fast -gamma 2 -Bounce inf"));
    EXPECT_NE(OptionsWithoutBounces("-sky 1 2"), OptionsWithoutBounces("-sky 12"));
}

TEST(BounceErrorsTest, LimitsAreNumbersOfBounces) {
    EXPECT_EQ(kBounceLimits[LimitIndexOf(1)], 1);
    EXPECT_EQ(kBounceLimits[LimitIndexOf(8)], 8);
    EXPECT_EQ(LimitIndexOf(100), kAllBounces);
    EXPECT_THROW(LimitIndexOf(7), std::exception);
}

} // namespace

} // namespace q3::test
