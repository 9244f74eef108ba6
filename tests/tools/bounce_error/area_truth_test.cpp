// GPL-2.0-or-later. True direct light against closed forms, and the errors of bakes against it.
#include "common/error.h"
#include "tests/tools/bounce_error/bounce_fixture.h"
#include "tools/measure/bounce_error/direct_errors.h"

#include <cmath>
#include <numbers>

namespace q3::test {

namespace {

using namespace bounce;

constexpr double kPerTurn = 1 / (2 * std::numbers::pi);

/// Form factor of the rectangle between a corner over the receiver and (x, y), in a plane that it faces at distance h;
/// odd in x and in y.
double FacingCorner(double x, double y, double h) {
    const double a = x / h, b = y / h, rootA = std::sqrt(1 + a * a), rootB = std::sqrt(1 + b * b);
    return kPerTurn * (a / rootA * std::atan(b / rootA) + b / rootB * std::atan(a / rootB));
}
/// Of the rectangle x0..x1, y0..y1, relative to the point over the receiver.
double FacingRectangle(double x0, double x1, double y0, double y1, double h) {
    return FacingCorner(x1, y1, h) - FacingCorner(x0, y1, h) - FacingCorner(x1, y0, h) + FacingCorner(x0, y0, h);
}
/// Form factor of an upright rectangle that stands on the receiver's plane at distance c, of height a, from straight
/// ahead to b units to one side.
double UprightRectangle(double a, double b, double c) {
    const double x = a / b, y = c / b, root = std::sqrt(x * x + y * y);
    return kPerTurn * (std::atan(1 / y) - y / root * std::atan(1 / root));
}

constexpr const char *kGlow = R"(textures/test/glow
{
	cull disable
	q3map_surfacelight 300
	q3map_lightRGB 0.3 0.9 0.6
	q3map_backsplash 0 0
}
)";
constexpr const char *kGlowName = "textures/test/glow", *kWallName = "textures/test/wall";
constexpr float kFloor = -200;

/// The light of a lamp per unit of form factor.
Vec3f LampLight(const TracedScene &scene) {
    const Light &light = scene.lights->Lights().front();
    return light.color * light.radiosity;
}
/// A lamp of 128 x 128 at height 0 over the origin.
SceneBuilder GlowRoom() {
    SceneBuilder scene;
    scene.SetInterior({-256, -256, -256}, {256, 256, 256}, {kWallName});
    scene.SetWorldKey("_keepLights", "1");
    scene.AddQuad({Vec3f{-64, -64, 0}, {-64, 64, 0}, {64, 64, 0}, {64, -64, 0}}, {kGlowName});
    return scene;
}
SurfacePoint FloorPoint(float x, float y) {
    SurfacePoint at;
    at.position = {x, y, kFloor}, at.normal = {0, 0, 1};
    return at;
}
LuxelTruth TruthAt(const TracedScene &scene, const SurfacePoint &at, const std::vector<Vec3f> &around = {}) {
    return DirectTruth(scene.in, *scene.lights).At({{at}, {}, around}, 1);
}
void ExpectLight(const LuxelTruth &truth, const Vec3f &expected, double share) {
    for (std::size_t c = 0; c < 3; ++c) {
        const double exact = double(expected[c]) * share;
        EXPECT_NEAR(truth.light[c], exact, 4 * double(truth.error[c]) + 1e-4 * exact) << c;
        EXPECT_LT(truth.error[c], 0.1f);
    }
}

TEST_F(PathTest, ASquareLampHasItsFormFactor) {
    Script(kGlow);
    const auto scene = Make(GlowRoom(), 0.5f);
    scene->Prepare();
    for (const auto &[x, y] : {std::array{0.0f, 0.0f}, {64.0f, 64.0f}, {-200.0f, 30.0f}}) {
        const double dx = double(x), dy = double(y);
        const double share = FacingRectangle(-64 - dx, 64 - dx, -64 - dy, 64 - dy, -double(kFloor));
        const LuxelTruth truth = TruthAt(*scene, FloorPoint(x, y), {{x + 16, y, kFloor}});
        ExpectLight(truth, LampLight(*scene), share);
        EXPECT_FALSE(truth.penumbra || truth.contact || truth.crossedLamps || truth.nearEdge);
    }
}

TEST_F(PathTest, AReceiverBesideALampIsNotMoved) {
    Script(kGlow);
    const auto scene = Make(GlowRoom(), 0.5f);
    scene->Prepare();
    SurfacePoint at; // half a unit over the plane of the lamp's back and 4 units beside the lamp, facing it
    at.position = {68, 0, 0.5f}, at.normal = {-1, 0, 0};
    // Seen from there the lamp lies like an upright rectangle: its height is its depth, its distance that of its plane.
    const auto upTo = [](double depth) { return 2 * UprightRectangle(depth, 64, 0.5); };
    const LuxelTruth truth = TruthAt(*scene, at);
    ExpectLight(truth, LampLight(*scene), upTo(132) - upTo(4));
    EXPECT_TRUE(truth.contact);
    at.twoSided = true, at.normal = {1, 0, 0};
    ExpectLight(TruthAt(*scene, at), LampLight(*scene), upTo(132) - upTo(4));
}

TEST_F(PathTest, AHalfCoveredLampGivesTheLightOfItsVisiblePart) {
    Script(kGlow);
    SceneBuilder room = GlowRoom();
    room.AddBox({-256, -256, -100}, {0, 256, -98}, {kWallName});
    const auto scene = Make(room, 0.5f);
    scene->Prepare();
    for (const float x : {20.0f, 0.5f, -30.0f}) {
        // The cover ends at x = 0; of its edges, the one that is passed last is that at -98 on its side, -100 beyond.
        const double dx = double(x), height = x > 0 ? 102 : 100, edge = -dx * 200 / height;
        const double share = FacingRectangle(std::max(-64 - dx, edge), 64 - dx, -64, 64, 200);
        const LuxelTruth truth = TruthAt(*scene, FloorPoint(x, 0), {{x + 32, 0, kFloor}});
        ExpectLight(truth, LampLight(*scene), share);
        EXPECT_GT(truth.error.y, 0);
        EXPECT_TRUE(truth.penumbra);
        EXPECT_TRUE(truth.nearEdge);
        EXPECT_FALSE(truth.crossedLamps);
    }
    EXPECT_FALSE(TruthAt(*scene, FloorPoint(-200, 0)).penumbra);
    ExpectLight(TruthAt(*scene, FloorPoint(-200, 0)), {}, 0);
}

TEST_F(PathTest, ALampThatCrossesTheHorizonGivesTheLightOfItsUpperPart) {
    Script(kGlow);
    SceneBuilder room;
    room.SetInterior({-256, -256, -256}, {256, 256, 256}, {kWallName});
    room.SetWorldKey("_keepLights", "1");
    room.AddQuad({Vec3f{100, -64, -250}, {100, -64, -136}, {100, 64, -136}, {100, 64, -250}}, {kGlowName});
    const auto scene = Make(room, 0.5f);
    scene->Prepare();
    const double upper = 2 * UprightRectangle(64, 64, 100), lower = 2 * UprightRectangle(50, 64, 100);
    SurfacePoint at = FloorPoint(0, 0);
    ExpectLight(TruthAt(*scene, at), LampLight(*scene), upper);
    at.normal = {0, 0, -1};
    ExpectLight(TruthAt(*scene, at), LampLight(*scene), lower);
    at.twoSided = true;
    ExpectLight(TruthAt(*scene, at), LampLight(*scene), upper + lower);
}

TEST_F(PathTest, LampsThatHideLampsAreFound) {
    Script(kGlow);
    SceneBuilder room = GlowRoom();
    room.AddQuad({Vec3f{0, -64, -64}, {0, -64, 64}, {0, 64, 64}, {0, 64, -64}}, {kGlowName});
    const auto scene = Make(room, 0.5f);
    scene->Prepare();
    EXPECT_TRUE(TruthAt(*scene, FloorPoint(100, 0)).crossedLamps);
    // Of a floor point straight below, only the lower half of the upright lamp is seen from its edge.
    EXPECT_FALSE(TruthAt(*scene, FloorPoint(0.01f, 0)).crossedLamps);
}

TEST_F(PathTest, DirectTruthDoesNotDependOnThreadsAndIsKept) {
    Script(kGlow);
    SceneBuilder room = GlowRoom();
    room.AddBox({-256, -256, -100}, {0, 256, -98}, {kWallName});
    room.AddEntity({{{"classname", "light"}, {"origin", "100 0 100"}, {"light", "200"}}});
    const std::filesystem::path cache = folder / "cache";
    DirectReference first;
    for (const int threads : {1, 3}) {
        const auto scene = Make(room, 0.5f, threads);
        scene->Prepare();
        std::vector<TruthReceiver> receivers;
        for (const LuxelReceiver &luxel : LuxelsByArea(scene->in, scene->surfaces, scene->tracer->Scene(), 20, 1))
            receivers.push_back(TruthReceiverOf(scene->surfaces, luxel));
        ASSERT_EQ(receivers.size(), 20u);
        const DirectReference found = MakeDirectReference(scene->in, *scene->lights, receivers, {});
        if (threads == 1)
            first = found;
        EXPECT_EQ(found.luxels, first.luxels);
        EXPECT_EQ(MakeDirectReference(scene->in, *scene->lights, receivers, cache).fromCache, threads == 3);
        const DirectReference again = MakeDirectReference(scene->in, *scene->lights, receivers, cache);
        EXPECT_TRUE(again.fromCache);
        EXPECT_EQ(again.luxels, first.luxels);
        receivers.front().ambient.x += 1;
        EXPECT_EQ(MakeDirectReference(scene->in, *scene->lights, receivers, cache).fromCache, threads == 3);
    }
}

TEST_F(PathTest, BakesOfLampsInTheOpenAgreeWithTheTruth) {
    Script(kGlow);
    const VirtualFileSystem &files = Files();
    KeptLog log;
    const MeasuredMap map{files, *FindGame("quake3"), GlowRoom().Build(), {"test", {}, {}}, log.log};
    LightmapOptions sampled = options;
    sampled.samples = 2;
    EXPECT_THROW(MapSetup(map, {{}, sampled}), Error);
    EXPECT_NO_THROW(MapSetup(map, {{}, sampled}, MeasuredLight::Direct));
    const MapSetup setup(map, {{}, options});
    const JobPool jobs(1);
    SurfaceLight surfaces;
    const BakedLuxels baked = BakeLuxels(setup, 0, jobs, log.log, &surfaces);
    const LightSetup &light = setup.light;
    const SurfaceInputs in{light.bsp,   light.space, light.scene, light.table, light.options, setup.settings.lightmap,
                           light.world, jobs,        log.log};
    int culled = 0;
    const DirectLights lights(
        in, SetupEnvelopes(light.lights, LightPass::Surfaces, light.options, light.space, light.skySeenFrom, culled));
    const PathScene scene(in, surfaces);
    const auto luxels = LuxelsByArea(in, surfaces, scene, 300, 1);
    std::vector<TruthReceiver> receivers;
    for (const LuxelReceiver &luxel : luxels)
        receivers.push_back(TruthReceiverOf(surfaces, luxel));
    const DirectReference truth = MakeDirectReference(in, lights, receivers, {});
    EXPECT_THROW(LightAt(surfaces, luxels, {}), Error);
    const auto found = CompareDirect(surfaces, luxels, truth.luxels, LightAt(surfaces, luxels, baked));
    int compared = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const double exact = double(found[i].light.traced.y);
        if (std::abs(luxels[i].position.z) <= 10 || luxels[i].places.size() > 1 || exact < 1)
            continue; // moved off the lamp's plane by the bake, at the edge of a wall, or faint
        EXPECT_NEAR(found[i].light.bounced.y, exact, 0.01 * exact + 0.1) << luxels[i].position.z;
        ++compared;
    }
    EXPECT_GT(compared, 150);
}

TEST(DirectErrorsTest, SharesAreByCause) {
    std::vector<ComparedDirect> light(4);
    light[0] = {{{}, {30, 0, 0}, {10, 0, 0}, {}}, ErrorCause::Contact, false};
    light[1] = {{{}, {30, 0, 0}, {10, 0, 0}, {}}, ErrorCause::Penumbra, true};
    light[2] = {{{}, {300, 5, 0}, {260, 5, 0}, {}}, ErrorCause::Rest, false};
    light[3] = {{{}, {0, 9, 0}, {0, 0, 0}, {}}, ErrorCause::Rest, false};
    const DirectErrors errors = DirectErrorsOf(light);
    EXPECT_EQ(errors.grossShare, 0.25);
    EXPECT_NEAR(errors.squares[std::size_t(ErrorCause::Contact)], 400.0 / 881, 1e-9);
    EXPECT_NEAR(errors.squares[std::size_t(ErrorCause::Penumbra)], 400.0 / 881, 1e-9);
    EXPECT_NEAR(errors.squares[std::size_t(ErrorCause::Rest)], 81.0 / 881, 1e-9);
    EXPECT_EQ(errors.receivers[std::size_t(ErrorCause::Rest)], 0.5);
    EXPECT_NEAR(errors.all.rmse, std::sqrt(881 / 12.0), 1e-6);
}

TEST(DirectErrorsTest, TooBrightPointsAreRemoved) {
    std::vector<ComparedDirect> light(3);
    light[0].light.bounced = {251, 0, 0}, light[1].light.bounced = {100, 0, 0}, light[2].light.bounced = {250, 0, 0};
    std::vector<LuxelReceiver> luxels(3);
    luxels[1].luxel = 1, luxels[2].luxel = 2;
    RemoveTooBright(luxels, light);
    ASSERT_EQ(light.size(), 2u);
    ASSERT_EQ(luxels.size(), 2u);
    EXPECT_EQ(light[1].light.bounced.x, 250);
    EXPECT_EQ(luxels[1].luxel, 2u);
}

TEST_F(PathTest, CausesAndNearestLuxels) {
    const auto scene = Make(Room(), 0.5f);
    scene->Prepare();
    const auto nearest = [&](const AskedPlace &place) {
        return NearestLuxel(scene->in, scene->surfaces, scene->tracer->Scene(), place);
    };
    const auto floor = nearest({{3, 5, -250}, {}});
    ASSERT_TRUE(floor);
    EXPECT_LT(Length(floor->position - Vec3f{3, 5, -255}), 16);
    EXPECT_EQ(floor->normal, (Vec3f{0, 0, 1}));
    EXPECT_EQ(TruthReceiverOf(scene->surfaces, *floor).around.size(), 24u);
    const auto wall = nearest({{3, 5, -250}, {1, 0, 0}});
    ASSERT_TRUE(wall);
    EXPECT_EQ(wall->normal, (Vec3f{1, 0, 0}));
    const LuxelReceiver itself = AtPlace(*wall, {{-256, 5, -250}, {1, 0, 0}});
    EXPECT_EQ(itself.luxel, wall->luxel);
    EXPECT_EQ(itself.places, (std::vector<Vec3f>{{-255, 5, -250}}));
    LuxelTruth truth;
    EXPECT_EQ(CauseOf(scene->surfaces, *floor, truth), ErrorCause::Rest);
    const auto corner = nearest({{250, 250, -250}, {0, 0, 1}});
    ASSERT_TRUE(corner);
    EXPECT_EQ(CauseOf(scene->surfaces, *corner, truth), ErrorCause::Seams);
    truth.penumbra = true;
    EXPECT_EQ(CauseOf(scene->surfaces, *corner, truth), ErrorCause::Penumbra);
    truth.contact = true;
    EXPECT_EQ(CauseOf(scene->surfaces, *corner, truth), ErrorCause::Contact);
    truth.crossedLamps = true;
    EXPECT_EQ(CauseOf(scene->surfaces, *corner, truth), ErrorCause::CrossedLamps);
}

} // namespace

} // namespace q3::test
