// GPL-2.0-or-later. References of luxels and positions, and errors against them.
#include "tests/bounce/bounce_fixture.h"
#include "tools/bounce_error/bounce_errors.h"

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

TEST(BounceErrorsTest, LimitsAreNumbersOfBounces) {
    EXPECT_EQ(kLimits[LimitOf(1)], 1);
    EXPECT_EQ(kLimits[LimitOf(8)], 8);
    EXPECT_EQ(LimitOf(100), kAllBounces);
    EXPECT_THROW(LimitOf(7), std::exception);
}

} // namespace

} // namespace q3::test
