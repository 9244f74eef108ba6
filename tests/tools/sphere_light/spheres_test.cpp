// GPL-2.0-or-later. What ioquake3 shows on a sphere, and where its camera sees one.
#include "tests/support/grid_readers/legacy_reader.h"
#include "tests/support/scene/scene_builder.h"
#include "tools/measure/sphere_light/engine_light.h"
#include "tools/measure/sphere_light/sphere_places.h"

#include <gtest/gtest.h>

namespace q3::test {

namespace {

const SceneShader kWallShader{"textures/test/wall"};
const Vec3f kMins{-512, -384, 0}, kMaxs{512, 384, 256};
const Vec3f kPillarMins{-64, -64, 0}, kPillarMaxs{64, 64, 256};

/// A room with a pillar in the middle, and a legacy grid of the same value everywhere.
Bsp Room(const bspGridPoint_t &point) {
    SceneBuilder scene;
    scene.SetInterior(kMins, kMaxs, kWallShader);
    scene.AddBox(kPillarMins, kPillarMaxs, kWallShader);
    Bsp bsp = scene.Build();
    const LegacyPlaces places(Vec3f(bsp.models[0].mins), Vec3f(bsp.models[0].maxs), {64, 64, 128});
    bsp.gridPoints.assign(places.Points(), point);
    return bsp;
}

/// What is shown of the legacy grid on a normal, away from the borders.
Vec3f Legacy(const bspGridPoint_t &point, Renderer renderer, int shift, const Vec3f &normal) {
    return LegacyGridLight(Room(point), renderer, shift)({200, 200, 100})(normal);
}

/// What is shown of the room with an SH grid of one point, which has the same light from all sides.
EngineLight EvenLight(const Vec3f &color, int shift, std::vector<std::byte> &file) {
    Bsp bsp = Room({});
    constexpr float kCoeff0OfLight1 = 3.544907702f; // 1 / Y(0)
    bsp.gridSH = LightGridSH{{{0, 0, 0}, {32, 32, 32}, {1, 1, 1}, 1}, {{}}};
    bsp.gridSH->points[0].coeffs[0] = (color * kCoeff0OfLight1).Array();
    bsp.gridSHContainer = GridSHContainer::Bspx;
    file = WriteBsp(bsp, {});
    return SHGridLight(file, bsp, shift);
}

void ExpectNear(const Vec3f &a, const Vec3f &b) {
    EXPECT_LT(Length(a - b), 0.01f) << a.x << " " << a.y << " " << a.z;
}

const bspGridPoint_t kFromAbove{{{100, 50, 0}}, {{60, 100, 20}}, kOnlyStyle0, {0, 0}};
const Vec3f kUp{0, 0, 1}, kDown{0, 0, -1};

TEST(SphereView, NormalsOfPixels) {
    const SpherePlace place{{10, 20, 30}, 90};
    const Image image{800, 600, {}};
    const auto middle = SphereNormal(place, image, 400, 300);
    ASSERT_TRUE(middle);
    EXPECT_LT(Length(*middle - Vec3f{0, -1, 0}), 0.02f); // to the camera, which looks along +y
    const auto right = SphereNormal(place, image, 440, 300), above = SphereNormal(place, image, 400, 260);
    ASSERT_TRUE(right && above);
    EXPECT_GT(right->x, 0.5f);
    EXPECT_GT(above->z, 0.5f);
    EXPECT_FALSE(SphereNormal(place, image, 500, 300));
}

TEST(SphereView, CoversTheDiskOfTheSphere) {
    const SpherePlace place;
    const Image image{800, 600, {}};
    const float radius = 400 * std::tan(std::asin(kSphereRadius / kSphereDistance));
    int count = 0;
    for (int row = 0; row < image.height; ++row)
        for (int column = 0; column < image.width; ++column)
            count += SphereNormal(place, image, column, row).has_value();
    EXPECT_GT(float(count), 0.95f * 3.14159f * radius * radius);
    EXPECT_LT(float(count), 3.14159f * radius * radius);
}

TEST(SpherePlaces, HaveAFreeViewAboveTheFloor) {
    const Bsp bsp = Room(kFromAbove);
    const auto places = FindSpherePlaces(bsp, 200, [](const Vec3f &) { return true; });
    ASSERT_EQ(places.size(), 200u);
    for (const SpherePlace &place : places)
        for (int step = 0; step <= 10; ++step) {
            const Vec3f p = place.Eye() + (place.center - place.Eye()) * (float(step) / 10);
            const Boundsf room{kMins, kMaxs}, pillar{kPillarMins, kPillarMaxs};
            EXPECT_TRUE(room.Contains(p));
            EXPECT_GT(pillar.Distance(p), kSphereRadius);
            EXPECT_GT(p.z, kSphereRadius);
        }
}

TEST(SpherePlaces, AreLit) {
    const Bsp bsp = Room(kFromAbove);
    for (const SpherePlace &place : FindSpherePlaces(bsp, 50, [](const Vec3f &p) { return p.x > 100; }))
        EXPECT_GT(place.center.x, 100);
    EXPECT_THROW(FindSpherePlaces(bsp, 1, [](const Vec3f &) { return false; }), std::exception);
}

TEST(EngineLight, LegacyGridIsScaledAndRaised) {
    for (const Renderer renderer : {Renderer::OpenGL1, Renderer::OpenGL2}) {
        ExpectNear(Legacy(kFromAbove, renderer, 0, kDown), {92, 62, 32});
        ExpectNear(Legacy(kFromAbove, renderer, 0, kUp), {152, 162, 52});
    }
}

TEST(EngineLight, RenderersLimitTheLegacyGridDifferently) {
    // Shifted by 2 and limited: ambient 255 127 0, directed 153 255 51. Then ambient * 0.6 + 32 is 185 108.2 32.
    ExpectNear(Legacy(kFromAbove, Renderer::OpenGL1, 2, kDown), {185, 108, 32});
    ExpectNear(Legacy(kFromAbove, Renderer::OpenGL2, 2, kDown), {185, 108.2f, 32});
    ExpectNear(Legacy(kFromAbove, Renderer::OpenGL1, 2, kUp), {255, 255, 83});
}

TEST(EngineLight, OnlyRenderer1LeavesOutPointsWithoutAmbientLight) {
    const bspGridPoint_t directedOnly{{{0, 0, 0}}, {{60, 100, 20}}, kOnlyStyle0, {0, 0}};
    ExpectNear(Legacy(directedOnly, Renderer::OpenGL1, 0, kUp), {32, 32, 32});
    ExpectNear(Legacy(directedOnly, Renderer::OpenGL2, 0, kUp), {92, 132, 52});
}

TEST(EngineLight, SHGridIsShiftedKeepingTheHue) {
    std::vector<std::byte> file;
    ExpectNear(EvenLight({0.2f, 0.1f, 0}, 0, file)({5, 5, 5})(kUp), {51, 25.5f, 0});
    ExpectNear(EvenLight({0.2f, 0.1f, 0}, 2, file)({5, 5, 5})(kDown), {204, 102, 0});
    ExpectNear(EvenLight({0.5f, 0.25f, 0}, 2, file)({5, 5, 5})(kDown), {255, 127.5f, 0});
}

} // namespace

} // namespace q3::test
