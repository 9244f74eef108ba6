// GPL-2.0-or-later. The path tracer against closed forms.
#include "q3map2/lightmap/bounce/bounce_scene.h"
#include "tests/tools/bounce_error/bounce_fixture.h"

#include <cmath>
#include <numbers>

namespace q3::test {

namespace {

using bounce::Estimate;
using bounce::kAllBounces;
using bounce::kBounceLimits;
using bounce::LimitIndexOf;

constexpr std::size_t kOneBounce = 0;
constexpr const char *kWall = "textures/test/wall", *kBright = "textures/test/bright";

/// Form factor from a point right before the center of a square to an equal square opposite at the distance of its
/// side: four times that of a quarter, X = Y = 1/2.
double CenterOfOppositeWall() {
    const double x = 0.5, root = std::sqrt(1 + x * x);
    return 4 / (2 * std::numbers::pi) * 2 * (x / root * std::atan(x / root));
}

TEST_F(PathTest, AFurnaceFollowsTheGeometricSeries) {
    for (const float reflectance : {0.25f, 0.5f, 0.75f}) {
        const auto scene = Make(Room(), reflectance);
        scene->Shine(kWall, 40);
        scene->Prepare();
        const Estimate found = scene->At({0, 0, -kHalf + 0.01f}, {0, 0, 1}, 1 << 16);
        for (std::size_t limit = 0; limit < kBounceLimits.size(); ++limit) {
            const double rest = limit == kAllBounces ? 0 : std::pow(double(reflectance), kBounceLimits[limit] + 1);
            const double expected = 40 * (double(reflectance) - rest) / (1 - double(reflectance));
            EXPECT_NEAR(found.light[limit].x, expected, 0.01 * expected) << reflectance << " " << limit;
            EXPECT_NEAR(found.light[limit].z, expected, 4 * double(found.error[limit].z) + 1e-4 * expected);
        }
    }
}

TEST_F(PathTest, AFurnaceLightsAllNormalsOfAPositionAlike) {
    const auto scene = Make(Room(), 0.5f);
    scene->Shine(kWall, 40);
    scene->Prepare();
    std::vector<Vec3f> normals;
    for (const Vec3d &normal : bench::Normals())
        normals.push_back(Vec3f(normal));
    for (const Estimate &found : scene->tracer->InSpace({30, -70, 100}, normals, 1 << 15, 5)) {
        EXPECT_NEAR(found.light[kOneBounce].x, 20, 0.2);
        EXPECT_NEAR(found.light[kAllBounces].x, 40, 0.4);
    }
}

TEST_F(PathTest, WallsOfACubeHaveTheirFormFactors) {
    SceneBuilder room = Room();
    room.SetWallShader(BoxFace::PlusX, {kBright});
    const auto scene = Make(room, 0.5f);
    scene->Shine(kBright, 200);
    scene->Prepare();
    // Hottel's crossed strings do not apply; tables of view factors: opposite 0.1998, adjacent 0.2000.
    const std::pair<BoxFace, double> walls[] = {
        {BoxFace::MinusX, 0.199825}, {BoxFace::PlusY, 0.200044}, {BoxFace::MinusZ, 0.200044}, {BoxFace::PlusX, 0}};
    for (const auto &[wall, factor] : walls) {
        double sum = 0;
        const auto places = PlacesOn(wall, 24);
        for (std::size_t i = 0; i < places.size(); ++i)
            sum += double(scene->At(places[i], InwardOf(wall), 512, i).light[kOneBounce].x);
        EXPECT_NEAR(sum / double(places.size()), 100 * factor, 0.01 * 100 * 0.2) << int(wall);
    }
}

TEST_F(PathTest, NoLightIsLostBetweenWalls) {
    SceneBuilder room = Room();
    room.SetWallShader(BoxFace::PlusX, {kBright});
    const auto scene = Make(room, 0.6f);
    scene->Shine(kBright, 600);
    scene->Prepare();
    std::array<double, kBounceLimits.size()> mean{};
    for (int wall = 0; wall < 6; ++wall) {
        const auto places = PlacesOn(BoxFace(wall), 24);
        for (std::size_t i = 0; i < places.size(); ++i) {
            const Estimate found = scene->At(places[i], InwardOf(BoxFace(wall)), 512, std::size_t(wall) << 32 | i);
            for (std::size_t limit = 0; limit < mean.size(); ++limit)
                mean[limit] += double(found.light[limit].y) / double(6 * places.size());
        }
    }
    // All walls reflect alike, so bounce k has 0.6^k of the 100 that the mean wall gets.
    for (const int bounces : {1, 2, 4, 8})
        EXPECT_NEAR(mean[LimitIndexOf(bounces)], 100 * 0.6 * (1 - std::pow(0.6, bounces)) / 0.4, 1) << bounces;
    EXPECT_NEAR(mean[kAllBounces], 150, 1.5);
}

TEST_F(PathTest, SeedsScatterAsTheStandardErrorSays) {
    SceneBuilder room = Room();
    room.SetWallShader(BoxFace::PlusX, {kBright});
    const auto scene = Make(room, 0.5f);
    scene->Shine(kBright, 200);
    scene->Prepare();
    const Vec3f place{-kHalf + 0.01f, 0, 0}, normal{1, 0, 0};
    const double expected = 100 * CenterOfOppositeWall();
    double sum = 0, errors = 0;
    int within = 0;
    for (std::uint64_t seed = 0; seed < 16; ++seed) {
        const Estimate found = scene->At(place, normal, 4096, seed);
        sum += double(found.light[kOneBounce].x) / 16, errors += std::pow(double(found.error[kOneBounce].x), 2);
        within += std::abs(double(found.light[kOneBounce].x) - expected) < 2 * double(found.error[kOneBounce].x);
    }
    EXPECT_NEAR(sum, expected, 3 * std::sqrt(errors) / 16);
    EXPECT_NEAR(sum, expected, 0.01 * expected);
    EXPECT_GE(within, 12);
}

TEST_F(PathTest, TheErrorShrinksWithTheRootOfThePaths) {
    SceneBuilder room = Room();
    room.SetWallShader(BoxFace::PlusX, {kBright});
    const auto scene = Make(room, 0.5f);
    scene->Shine(kBright, 200);
    scene->Prepare();
    const auto errorOf = [&](int paths) {
        return double(scene->At({0, 0, -kHalf + 0.01f}, {0, 0, 1}, paths, 3).error[kAllBounces].x);
    };
    EXPECT_NEAR(errorOf(1 << 14) / errorOf(1 << 18), 4, 1);
}

TEST_F(PathTest, BlackWallsReflectNothing) {
    WallGray(0);
    SceneBuilder room = Room();
    room.AddEntity({{{"classname", "light"}, {"origin", "0 0 100"}, {"light", "500"}}});
    const auto scene = Make(room, 0.8f);
    scene->Shine(kWall, 100);
    scene->Prepare();
    EXPECT_EQ(scene->At({0, 0, -kHalf + 1}, {0, 0, 1}, 1024).light[kAllBounces], Vec3f{});
}

TEST_F(PathTest, ShadersCanKeepTheirLight) {
    Script("textures/test/wall\n{\n\tq3map_bounce 0\n\t{\n\t\tmap textures/test/wall.tga\n\t}\n}\n");
    const auto scene = Make(Room(), 0.8f);
    scene->Shine(kWall, 100);
    scene->Prepare();
    EXPECT_EQ(scene->At({0, 0, -kHalf + 1}, {0, 0, 1}, 1024).light[kAllBounces], Vec3f{});
}

TEST_F(PathTest, APointLightGivesWhatTheWallsGet) {
    SceneBuilder room = Room();
    room.AddEntity({{{"classname", "light"}, {"origin", "0 0 0"}, {"light", "300"}, {"spawnflags", "32"}}});
    const auto scene = Make(room, 0.5f);
    scene->Prepare();
    // Direct light a unit off a wall, 7500 * 300 cos / d^2, by the midpoint rule.
    double direct = 0;
    constexpr int kSteps = 400;
    for (int v = 0; v < kSteps; ++v)
        for (int u = 0; u < kSteps; ++u) {
            const double x = kHalf * ((2 * u + 1.0) / kSteps - 1), y = kHalf * ((2 * v + 1.0) / kSteps - 1);
            const double z = kHalf - 1, d2 = x * x + y * y + z * z;
            direct += 7500.0 * 300 * z / (d2 * std::sqrt(d2)) / (kSteps * kSteps);
        }
    double bounced = 0;
    for (int wall = 0; wall < 6; ++wall) {
        const auto places = PlacesOn(BoxFace(wall), 16);
        for (std::size_t i = 0; i < places.size(); ++i)
            bounced += double(scene->At(places[i], InwardOf(BoxFace(wall)), 1024, i).light[kAllBounces].x) /
                       double(6 * places.size());
    }
    EXPECT_NEAR(bounced, direct, 0.01 * direct); // 0.5 / (1 - 0.5)
}

/// A panel half a unit above the floor, with light on both sides, its front up or down.
SceneBuilder RoomWithPanel(bool up) {
    constexpr float kSide = 5000;
    SceneBuilder room;
    room.SetInterior({-kSide, -kSide, -256}, {kSide, kSide, 256}, {kWall});
    std::array<Vec3f, 4> corners{Vec3f{-kSide, -kSide, 0}, {-kSide, kSide, 0}, {kSide, kSide, 0}, {kSide, -kSide, 0}};
    if (!up)
        std::swap(corners[1], corners[3]);
    room.AddQuad(corners, {"textures/test/panel"});
    return room;
}

TEST_F(PathTest, BacksOfOneSidedSurfacesAreBlack) {
    for (const bool up : {true, false}) {
        const auto scene = Make(RoomWithPanel(up), 0.5f);
        scene->Shine("textures/test/panel", 100);
        scene->Prepare();
        const float above = scene->At({0, 0, 1}, {0, 0, -1}, 1024).light[kOneBounce].x;
        const float below = scene->At({0, 0, -1}, {0, 0, 1}, 1024).light[kOneBounce].x;
        EXPECT_NEAR(above, up ? 50 : 0, 0.01);
        EXPECT_NEAR(below, up ? 0 : 50, 0.01);
    }
}

TEST_F(PathTest, TwoSidedSurfacesReflectOnBothSides) {
    Script("textures/test/panel\n{\n\tcull disable\n\t{\n\t\tmap textures/test/panel.tga\n\t}\n}\n");
    const auto scene = Make(RoomWithPanel(true), 0.5f);
    scene->Shine("textures/test/panel", 100);
    scene->Prepare();
    EXPECT_NEAR(scene->At({0, 0, 1}, {0, 0, -1}, 1024).light[kOneBounce].x, 50, 0.01);
    EXPECT_NEAR(scene->At({0, 0, -1}, {0, 0, 1}, 1024).light[kOneBounce].x, 50, 0.01);
}

TEST_F(PathTest, ReflectanceIsThatOfTheTexel) {
    const std::vector<std::uint8_t> texels{255, 0, 0, 0, 102, 51};
    folder.Write("textures/test/two.tga", EncodeTga(texels, 2, 1, 3, TgaRows::TopFirst));
    SceneBuilder room = Room();
    room.SetWallShader(BoxFace::PlusZ, {"textures/test/two"});
    options.bounceColorRatio = 0.5f;
    const auto scene = Make(room, 0.5f);
    scene->Prepare();
    std::size_t surface = 0;
    while (scene->table[surface].shader->name != "textures/test/two")
        ++surface;
    const bounce::PathScene &traced = scene->tracer->Scene();
    // Half gray: red 255 of mean 85, green and blue 102, 51 of mean 51.
    const Vec3f left{0.5f * 170 / 255, 0.5f * 42.5f / 255, 0.5f * 42.5f / 255};
    const Vec3f right{0.5f * 25.5f / 255, 0.5f * 76.5f / 255, 0.5f * 51 / 255};
    for (const float s : {0.1f, 0.49f, 3.2f, -0.6f, -0.99f})
        EXPECT_LT(Length(traced.ReflectanceAt(surface, {s, 0.3f}) - left), 1e-6f) << s;
    for (const float s : {0.51f, 0.9f, 7.7f, -0.1f, -0.4f})
        EXPECT_LT(Length(traced.ReflectanceAt(surface, {s, -5.3f}) - right), 1e-6f) << s;
}

TEST_F(PathTest, LightNeverGrows) {
    const auto scene = Make(Room(), 5);
    scene->Prepare();
    EXPECT_EQ(scene->tracer->Scene().ReflectanceAt(0, {0, 0}).x, kMaxReflectance);
}

} // namespace

} // namespace q3::test
