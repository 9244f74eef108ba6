// GPL-2.0-or-later. Reference light against closed forms.
#include "q3map2/light/sources/falloff.h"
#include "tests/tools/shbench/bench_fixture.h"
#include "tools/measure/shbench/errors.h"
#include "tools/measure/shbench/truth_lights.h"

#include <array>
#include <cmath>
#include <fstream>
#include <numbers>

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using namespace bench;

constexpr double kPi = std::numbers::pi;

TruthPoint At(const BenchMap &map, const Vec3f &p, double noise = 0.02) {
    std::uint64_t rays = 0;
    return TruthAt(map, p, 1, noise, rays);
}

/// The L2 approximation of max(0, cos t): by Legendre polynomials, 1/4 + cos t / 2 + 5/32 (3 cos^2 t - 1).
double ClampedCosineL2(double cosine) {
    return 0.25 + cosine / 2 + 5.0 / 32 * (3 * cosine * cosine - 1);
}

/// Share of what a hemisphere gives that a polygon gives to an element at p with unit normal n, by Lambert's sum over
/// edges after clipping to the horizon. Corners in any order of turn.
double FormFactorOf(std::vector<Vec3d> corners, const Vec3d &p, const Vec3d &n) {
    std::vector<Vec3d> above;
    for (Vec3d &corner : corners)
        corner -= p;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d &a = corners[i], &b = corners[(i + 1) % corners.size()];
        const double da = Dot(a, n), db = Dot(b, n);
        if (da >= 0)
            above.push_back(a);
        if ((da > 0 && db < 0) || (da < 0 && db > 0))
            above.push_back(a + (b - a) * (da / (da - db)));
    }
    double sum = 0;
    for (std::size_t i = 0; i < above.size(); ++i) {
        const Vec3d &a = above[i], &b = above[(i + 1) % above.size()];
        const double angle = std::acos(std::clamp(Dot(Normalize(a), Normalize(b)), -1.0, 1.0));
        sum += angle * Dot(n, Normalize(Cross(a, b)));
    }
    return std::abs(sum) / (2 * kPi);
}

class TruthTest : public BenchTest {};

TEST_F(TruthTest, APointLightInAnEmptyRoomFallsOffByTheSquareOfItsDistance) {
    SceneBuilder scene = Room();
    scene.AddEntity(PointLight({0, 0, 100}, 200));
    const auto map = Map(scene);
    const Vec3f p{30, -40, 0};
    const TruthPoint point = At(*map, p);
    const Vec3d way = Vec3d(0, 0, 100) - Vec3d(p);
    const double light = 7500.0 * 200 / Dot(way, way) / 255;
    for (std::size_t i = 0; i < kNormals; ++i) {
        const double cosine = Dot(Normals()[i], Normalize(way));
        EXPECT_NEAR(double(point.light[i].x), light * std::max(0.0, cosine), 1e-5 * light);
        EXPECT_NEAR(double(ProjectedLight(point)[i].x), light * std::max(0.0, ClampedCosineL2(cosine)), 1e-5 * light);
    }
}

TEST_F(TruthTest, KnowsTheCurvesAndConesOfTheProgram) {
    std::vector<Light> lights(6);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        lights[i].photons = 1000;
        lights[i].origin = {10, 20, 30};
        lights[i].extraDist = i == 2 ? 20.0f : 0;
    }
    lights[1].curve = FalloffCurve::Linear;
    lights[1].photons = 8000 * 300;
    lights[2].curve = FalloffCurve::Windowed;
    lights[2].attenuation.end = 150;
    lights[3].curve = lights[4].curve = FalloffCurve::Polynomial;
    lights[3].attenuation = {.constant = 2, .linear = 0.3f, .quadratic = 0.01f};
    lights[4].attenuation = {
        .constant = 2, .linear = 3, .quadratic = -0.01f, .flatFrom = 100, .fadeFrom = 80, .end = 170};
    lights[5].type = LightType::Spot;
    lights[5].normal = Normalize(Vec3f{1, 2, -1});
    lights[5].cone = {.byAngles = true, .cosInner = 0.9f, .cosOuter = 0.3f, .exponent = 2};
    int dark = 0;
    for (const Light &light : lights)
        for (int i = 1; i < 400; ++i) {
            const Vec3f way = Vec3f{float(i % 7) - 3, float(i % 11) - 5, float(i % 5) - 2.25f} * (float(i) / 10);
            const double share = light.type == LightType::Spot ? double(ConeFraction(light, -way)) : 1;
            const double wanted = std::max(0.0, double(Falloff(light).At(Length(way))) * share);
            EXPECT_NEAR(PointLightAt(light, Vec3d(light.origin + way)), wanted, 1e-3 * wanted + 1e-5) << i;
            dark += wanted == 0;
        }
    EXPECT_GT(dark, 100);
}

TEST_F(TruthTest, TheFloorOfOneDirectionIsTheErrorOfTheL2Cosine) {
    SceneBuilder scene = Room();
    scene.AddEntity(PointLight({0, 0, 100}, 4));
    const auto map = Map(scene);
    Truth truth;
    truth.points = {At(*map, {0, 0, 0})};
    const double light = 7500.0 * 4 / 1e4; // bytes: dark enough that nothing is cut
    double sum = 0;
    for (const Vec3d &n : Normals()) {
        const double error = std::max(0.0, ClampedCosineL2(n.z)) - std::max(0.0, n.z);
        sum += error * error;
    }
    EXPECT_NEAR(FloorError(truth), light * std::sqrt(sum / double(kNormals)), 1e-4);
}

TEST_F(TruthTest, ABoxInTheWayHidesAPointLight) {
    SceneBuilder scene = Room();
    scene.AddEntity(PointLight({0, 0, 100}, 200));
    scene.AddBox({-20, -20, 40}, {20, 20, 60}, {"textures/test/wall"}, BoxKind::Detail);
    const auto map = Map(scene);
    EXPECT_THAT(At(*map, {0, 0, 0}).light, testing::Each(Vec3f{}));
    EXPECT_GT(At(*map, {100, 0, 0}).light[0].x + At(*map, {100, 0, 0}).light[4].x, 0);
}

constexpr const char *kLamp = "textures/test/lamp\n{\n\tq3map_surfacelight 300\n\tq3map_lightRGB 1 1 1\n"
                              "\tq3map_backsplash 0 0\n}\n";
constexpr double kLampAdd = 300 * 3 * 0.25; ///< byte scale, of a hemisphere full of it

/// A lamp of 128 x 128 at height 200 that faces down.
const std::array<Vec3f, 4> kLampCorners = {{{-64, -64, 200}, {64, -64, 200}, {64, 64, 200}, {-64, 64, 200}}};

TEST_F(TruthTest, ASquareLampGivesItsFormFactor) {
    SceneBuilder scene = Room();
    scene.AddQuad(kLampCorners, {"textures/test/lamp"});
    const auto map = Map(scene, "", kLamp);
    ASSERT_FALSE(map->lights.empty());
    const std::vector<Vec3d> corners(kLampCorners.begin(), kLampCorners.end());
    for (const Vec3f &p : {Vec3f{0, 0, 0}, Vec3f{150, 30, 120}, Vec3f{20, -30, 170}, Vec3f{-300, 0, 190}}) {
        const TruthPoint point = At(*map, p);
        for (std::size_t i = 0; i < kNormals; ++i)
            EXPECT_NEAR(255 * double(point.light[i].x), kLampAdd * FormFactorOf(corners, Vec3d(p), Normals()[i]), 0.15)
                << p.x << " normal " << i;
    }
}

TEST_F(TruthTest, HalfOfALampBehindAWallGivesTheOtherHalf) {
    SceneBuilder scene = Room();
    scene.AddQuad(kLampCorners, {"textures/test/lamp"});
    // Straight above the place, close to the lamp: its edge hides just the part beyond x = 0.
    scene.AddBox({0, -200, 190}, {200, 200, 199}, {"textures/test/wall"}, BoxKind::Detail);
    const auto map = Map(scene, "", kLamp);
    const std::vector<Vec3d> half = {{-64, -64, 200}, {0, -64, 200}, {0, 64, 200}, {-64, 64, 200}};
    const TruthPoint point = At(*map, {0, 0, 0});
    for (std::size_t i = 0; i < kNormals; ++i)
        EXPECT_NEAR(255 * double(point.light[i].x), kLampAdd * FormFactorOf(half, {}, Normals()[i]), 0.3);
}

TEST_F(TruthTest, AmbientMinimumAndScaleAreThoseOfTheGrid) {
    SceneBuilder scene = Room();
    scene.SetWorldKey("_ambient", "20");
    scene.SetWorldKey("_color", "1 0.5 0.25");
    scene.SetWorldKey("_mingridlight", "12");
    const auto map = Map(scene, "-gridscale 2");
    const TruthPoint point = At(*map, {0, 0, 0});
    for (const Vec3f &light : point.light) {
        EXPECT_NEAR(double(light.x) * 255, 40, 1e-3);
        EXPECT_NEAR(double(light.y) * 255, 20, 1e-3);
        EXPECT_NEAR(double(light.z) * 255, 10, 1e-3); // of 0.25 x 20 and 0.25 x 12 the larger
    }
    for (const Vec3f &light : ProjectedLight(point))
        EXPECT_NEAR(double(light.x) * 255, 40, 1e-3);
}

TEST_F(TruthTest, ReportedNoiseFollowsTheGoal) {
    SceneBuilder scene = Room();
    scene.AddQuad(kLampCorners, {"textures/test/lamp"});
    scene.AddBox({-90, -90, 100}, {10, 20, 110}, {"textures/test/wall"}, BoxKind::Detail);
    const auto map = Map(scene, "", kLamp);
    const Truth truth = MakeTruth(*map, {.positions = 40, .seed = 3, .noise = 0.05}, JobPool(1));
    EXPECT_GT(truth.noise, 0);
    EXPECT_LT(truth.noise, 0.1);
}

TEST_F(TruthTest, PositionsKeepClearOfSolids) {
    SceneBuilder scene = Room();
    const Boundsf box{{-100, -100, -100}, {200, 100, 100}};
    scene.AddBox(box.mins, box.maxs, {"textures/test/wall"}, BoxKind::Structural);
    const Boundsf detail{{-400, -400, -400}, {-200, -200, 0}};
    scene.AddBox(detail.mins, detail.maxs, {"textures/test/wall"}, BoxKind::Detail);
    const auto map = Map(scene);
    const auto positions = PlayerPositions(*map, 500, 7);
    ASSERT_EQ(positions.size(), 500u);
    for (const Vec3f &p : positions) {
        for (const Boundsf &solid : {box, detail}) {
            const Vec3f out = Max(solid.mins - p, p - solid.maxs);
            EXPECT_GE(MaxComponent(out), 15.8f);
        }
        EXPECT_LE(MaxComponent(Max(p, -p)), float(kRoom) - 15.8f);
    }
    EXPECT_EQ(positions, PlayerPositions(*map, 500, 7));
    EXPECT_NE(positions, PlayerPositions(*map, 500, 8));
}

TEST_F(TruthTest, TheCacheReturnsTheSameAndKnowsAChangedLight) {
    SceneBuilder scene = Room();
    scene.AddQuad(kLampCorners, {"textures/test/lamp"});
    scene.AddEntity(PointLight({0, 0, 100}, 200));
    const auto map = Map(scene, "", kLamp);
    const TruthSettings settings{.positions = 20, .seed = 5};
    const auto cache = folder / "cache";
    const JobPool one(1), three(3);
    bool hit = true;
    const Truth made = CachedTruth(*map, settings, one, cache, hit);
    EXPECT_FALSE(hit);
    const Truth found = CachedTruth(*map, settings, one, cache, hit);
    EXPECT_TRUE(hit);
    EXPECT_EQ(made.points, found.points);
    EXPECT_EQ(made.noise, found.noise);
    EXPECT_EQ(made.points, MakeTruth(*map, settings, three).points); // of any number of threads

    SceneBuilder brighter = Room();
    brighter.AddQuad(kLampCorners, {"textures/test/lamp"});
    brighter.AddEntity(PointLight({0, 0, 100}, 201));
    EXPECT_NE(TruthKey(*map, settings), TruthKey(*Map(brighter), settings));
    EXPECT_NE(TruthKey(*map, settings), TruthKey(*map, {.positions = 20, .seed = 6}));
    EXPECT_NE(TruthKey(*map, settings), TruthKey(*Map(scene, "-gridscale 2"), settings));

    // A damaged file is made again.
    std::ofstream(cache / (TruthKey(*map, settings) + ".truth"), std::ios::trunc) << "short";
    EXPECT_EQ(CachedTruth(*map, settings, one, cache, hit).points, made.points);
    EXPECT_FALSE(hit);
}

} // namespace

} // namespace q3::test
