// GPL-2.0-or-later. Soft shadows on luxels (-areashadows): against closed forms and sums of lights.
#include "q3map2/light/batch/form_factor.h"
#include "q3map2/light/sources/hidden_lights.h"
#include "q3map2/light/sources/light_suns.h"
#include "q3map2/lightmap/direct/luxel_light.h"
#include "tests/lightmap/direct/test_lights.h"
#include "tests/support/surface_case.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace q3::test {

namespace {

/// A floor of 256 x 256 at height 0 in a room, and what casts shadows on it.
class SoftLuxelTest : public testing::Test {
  protected:
    static constexpr const char *kFloor = "textures/test/floor";

    /// Luxels of the floor under the lights.
    struct Luxel {
        Vec3f position, light, direction;
    };
    std::vector<Luxel> Bake(std::vector<Light> lights, int areaShadows, int threads = 1) {
        CaseSettings settings;
        settings.light.areaShadows = areaShadows;
        settings.lightmap.deluxe = true;
        settings.threads = threads;
        settings.script = "textures/test/sky\n{\nsurfaceparm sky\n}\n";
        SceneBuilder scene = scene_;
        scene.AddQuad(Rectangle(-128, -128, 128, 128, 0), Shaded(kFloor));
        SurfaceCase c(scene, folder_, settings);
        SurfaceLight surfaces = c.Mapped();
        int culled = 0;
        ContributionCounts counts;
        LightLuxels(c.Inputs(),
                    SetupEnvelopes(std::move(lights), LightPass::Surfaces, c.settings.light, c.space,
                                   SkySeenFrom(c.space, c.table), culled, false),
                    {}, surfaces, counts);
        rays_ = counts.rays;
        const RawLightmap &floor = LightmapOf(c, surfaces, kFloor);
        std::vector<Luxel> luxels;
        for (std::size_t i = 0; i < floor.luxelClusters.size(); ++i)
            if (floor.Mapped(i))
                luxels.push_back({floor.positions[i], floor.light[0][i], floor.directions[i]});
        EXPECT_GE(luxels.size(), 200u);
        return luxels;
    }

    SceneBuilder scene_ = EmptyRoom();
    GameFolder folder_;
    std::uint64_t rays_ = 0; ///< of the latest Bake, all surfaces
};

/// The part of a polygon in front of the plane through p and the points a, a + along, on the side of `inside`.
Winding<double> PartBeyondEdge(const Light &light, const Vec3f &p, const Vec3d &a, const Vec3d &along,
                               const Vec3d &inside) {
    Vec3d normal = Normalize(Cross(along, a - Vec3d(p)));
    if (Dot(normal, inside - Vec3d(p)) < 0)
        normal = -normal;
    Winding<double> part(light.polygon.begin(), light.polygon.end());
    ChopPolygon(part, {normal, Dot(normal, Vec3d(p))}, 0);
    return part;
}

/// Form factor of a polygon in front of a floor.
double OnFloor(const Vec3f &p, const Winding<double> &polygon) {
    const std::vector<Vec3f> corners(polygon.begin(), polygon.end());
    return polygon.size() < 3 ? 0 : FormFactor(Vec3d(p), Vec3d{0, 0, 1}, std::span<const Vec3f>(corners));
}

TEST_F(SoftLuxelTest, ThePenumbraOfAStraightEdgeIsItsClosedForm) {
    for (const auto &[height, radiosity] : {std::pair(16.0f, 2080.0f), {64.0f, 5760.0f}, {256.0f, 38400.0f}}) {
        scene_ = EmptyRoom();
        scene_.AddBox({-1000, -1000, height}, {0, 1000, height + 1}, Shaded("textures/test/wall"));
        const Light lamp = AreaLight({0, 0, 2 * height + 100}, 64, 96, {0, 0, -1},
                                     height == 64   ? 64 * 90
                                     : height == 16 ? 16 * 130
                                                    : 256 * 150);
        double most = 0, brightest = 0;
        for (const Luxel &luxel : Bake({lamp}, 512)) {
            const Vec3f &p = luxel.position;
            // The lower edge of the box hides more than the upper one where p is on its side, and less beyond it.
            const Vec3d edge{0, 0, double(p.x < 0 ? height : height + 1)};
            const double right = double(lamp.radiosity) *
                                 OnFloor(p, PartBeyondEdge(lamp, p, edge, {0, 1, 0}, {1000, 0, double(height)}));
            brightest = std::max(brightest, right);
            most = std::max(most, std::abs(double(luxel.light.x) - right));
        }
        EXPECT_GT(brightest, 150) << height;
        EXPECT_LT(most, 1) << height << ": of " << brightest;
    }
}

TEST_F(SoftLuxelTest, ALampWithACoveredMiddleIsStillSeen) {
    scene_.AddBox({-8, -200, 100}, {8, 200, 101}, Shaded("textures/test/wall"));
    const Light lamp = AreaLight({0, 0, 200}, 96, 96, {0, 0, -1}, 1000);
    double most = 0;
    int dark = 0;
    const std::vector<Luxel> hard = Bake({lamp}, 0), soft = Bake({lamp}, 1024);
    for (std::size_t i = 0; i < soft.size(); ++i) {
        const Vec3f &p = soft[i].position;
        if (std::abs(p.y) > 64) // beyond, the ends of the beam would count
            continue;
        double right = 0;
        for (const double side : {-8.0, 8.0}) {
            const Vec3d edge{side, 0, p.x * side < 0 || std::abs(double(p.x)) < 8 ? 100.0 : 101.0};
            right += 1000 * OnFloor(p, PartBeyondEdge(lamp, p, edge, {0, 1, 0}, {1000 * side, 0, 100}));
        }
        most = std::max(most, std::abs(double(soft[i].light.x) - right));
        dark += hard[i].light.x == 0 && right > 20;
    }
    EXPECT_GT(dark, 5) << "one ray to the middle sees nothing there";
    EXPECT_LT(most, 2);
}

// One ray goes to the middle of each part, so both sides of the crossing surface get the light of theirs.
TEST_F(SoftLuxelTest, ALampIsCutWhereASurfaceCrossesItsMiddle) {
    scene_.AddQuad({Vec3f{0, -60, 260}, {0, 60, 260}, {0, 60, 150}, {0, -60, 150}}, Shaded("textures/test/wall"));
    const SurfaceCase c(scene_, folder_);
    const Light lamp = AreaLight({0, 0, 200}, 96, 48, {0, 0, -1}, 1000),
                aside = AreaLight({200, 0, 200}, 96, 48, {0, 0, -1}, 1000);
    const std::vector<Light> lights = CutCrossedLights({lamp, aside}, c.space, c.scene);
    ASSERT_EQ(lights.size(), 3u);
    EXPECT_LT(lights[0].origin.x * lights[1].origin.x, -100) << "one on each side";
    EXPECT_FLOAT_EQ(lights[0].photons + lights[1].photons, lamp.photons);
    EXPECT_EQ(lights[2].origin, aside.origin);
}

TEST_F(SoftLuxelTest, TheDirectionIsThatOfTheVisiblePart) {
    scene_.AddBox({-1000, -1000, 100}, {0, 1000, 101}, Shaded("textures/test/wall"));
    const Light lamp = AreaLight({0, 0, 200}, 200, 64, {0, 0, -1}, 1000);
    int partly = 0;
    for (const Luxel &luxel : Bake({lamp}, 256)) {
        if (std::abs(luxel.position.x) > 20 || !(luxel.light.x > 1))
            continue;
        const Vec3f direction = Normalize(luxel.direction), toMiddle = Normalize(lamp.origin - luxel.position);
        EXPECT_GT(direction.x, toMiddle.x + 0.1f) << luxel.position.x;
        ++partly;
    }
    EXPECT_GT(partly, 20);
}

TEST_F(SoftLuxelTest, ALampBelowTheHorizonOfPartOfTheFloorShinesWithItsRest) {
    // It stands on the floor and reaches below it.
    Light lamp = AreaLight({-100, 0, 10}, 60, 80, {1, 0, 0}, 500);
    lamp.tolerance = 0;
    double most = 0;
    for (const Luxel &luxel : Bake({lamp}, 64)) {
        const Vec3f &p = luxel.position;
        if (p.x < -90)
            continue;
        Winding<double> above(lamp.polygon.begin(), lamp.polygon.end());
        ChopPolygon(above, {{0, 0, 1}, double(p.z)}, 0);
        most = std::max(most, std::abs(double(luxel.light.x) - 500 * OnFloor(p, above)));
    }
    EXPECT_LT(most, 0.5);
}

/// `count` suns through any sky, over a cone, all samples of one.
std::vector<Light> Suns(int count, float photons, bool colored) {
    std::vector<Light> suns;
    for (int i = 0; i < count; ++i) {
        Light sun;
        sun.type = LightType::Sun;
        const float angle = 2.4f * float(i), radius = 0.3f * std::sqrt(float(i) / float(count));
        sun.normal = -Normalize(Vec3f{0.2f + radius * std::cos(angle), radius * std::sin(angle), 1});
        sun.origin = sun.normal * -kSunDistance;
        sun.photons = photons / float(count);
        sun.color = colored ? Vec3f{1, 0.5f + 0.5f * float(i % 2), float(i) / float(count)} : Vec3f{1, 0.8f, 0.6f};
        sun.sample = i, sun.group = 0;
        suns.push_back(sun);
    }
    return suns;
}

TEST_F(SoftLuxelTest, SamplesOfOneSunAddUpToTheirSum) {
    scene_.SetWallShader(BoxFace::PlusZ, Shaded("textures/test/sky"));
    scene_.AddBox({-60, -1000, 120}, {0, 40, 140}, Shaded("textures/test/wall"));
    for (const bool colored : {false, true}) {
        const std::vector<Light> suns = Suns(64, 200, colored);
        const std::vector<Luxel> sums = Bake(suns, 0), soft = Bake(suns, 16);
        int partly = 0;
        double square = 0;
        for (std::size_t i = 0; i < sums.size(); ++i) {
            square += double(Dot(soft[i].light - sums[i].light, soft[i].light - sums[i].light)) / 3;
            partly += sums[i].light.x > 5 && sums[i].light.x < 150;
        }
        EXPECT_GT(partly, 30);
        EXPECT_LT(std::sqrt(square / double(sums.size())), 0.5);
    }
}

TEST_F(SoftLuxelTest, SunsAndLightsWithADeviationShineAsWithManySamples) {
    scene_.SetWallShader(BoxFace::PlusZ, Shaded("textures/test/sky"));
    scene_.AddBox({-60, -1000, 120}, {0, 40, 140}, Shaded("textures/test/wall"));
    LightOptions hard, soft;
    soft.areaShadows = 64;
    const auto sun = [](int samples) {
        return SunDirective{.direction = Normalize(Vec3f{0.2f, 0.1f, 1}),
                            .color = {1, 1, 1},
                            .photons = 200,
                            .deviance = 0.1f,
                            .samples = samples};
    };
    KeptLog log;
    const auto lamp = [&](int samples, const LightOptions &options) {
        const Entity light = MakeEntity(
            "light",
            {{"origin", "-30 20 260"}, {"light", "900"}, {"_deviance", "20"}, {"_samples", std::to_string(samples)}});
        return EntityLights({MakeEntity("worldspawn", {}), light}, options, log.log);
    };
    const auto expectAlike = [&](const std::vector<Light> &many, const std::vector<Light> &few,
                                 const std::vector<Light> &softened) {
        const std::vector<Luxel> right = Bake(many, 0), bands = Bake(few, 0), got = Bake(softened, 64);
        double square = 0, ofBands = 0;
        for (std::size_t i = 0; i < right.size(); ++i) {
            square += std::pow(double(got[i].light.x - right[i].light.x), 2);
            ofBands += std::pow(double(bands[i].light.x - right[i].light.x), 2);
        }
        EXPECT_LT(std::sqrt(square / double(right.size())), 2);
        EXPECT_GT(std::sqrt(ofBands / double(right.size())), 4);
    };
    expectAlike(MakeSuns(sun(256), -1, hard), MakeSuns(sun(4), -1, hard), MakeSuns(sun(4), -1, soft));
    expectAlike(lamp(1024, hard), lamp(4, hard), lamp(4, soft));
}

// Five sides of a cube around the floor, four of which reach below its horizon, fill the hemisphere of each luxel.
TEST_F(SoftLuxelTest, InAFurnaceEveryLuxelGetsTheRadiosity) {
    std::vector<Light> sides;
    for (const Vec3f &inward : {Vec3f{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, -1}})
        sides.push_back(AreaLight(inward * -1000, 2000, 2000, inward, 100));
    for (const Luxel &luxel : Bake(sides, 64))
        ASSERT_NEAR(luxel.light.x, 100, 0.1) << luxel.position.x << " " << luxel.position.y;
}

TEST_F(SoftLuxelTest, LightsAddUp) {
    scene_.AddBox({-60, -50, 60}, {40, 40, 80}, Shaded("textures/test/wall"));
    const Light a = AreaLight({0, 0, 200}, 96, 96, {0, 0, -1}, 300),
                b = AreaLight({90, 50, 150}, 30, 20, {0, 0, -1}, 900);
    const std::vector<Luxel> both = Bake({a, b}, 64), first = Bake({a}, 64), second = Bake({b}, 64);
    for (std::size_t i = 0; i < both.size(); ++i)
        ASSERT_NEAR(both[i].light.x, first[i].light.x + second[i].light.x, 1e-3);
}

/// Light of one prepared light at a place, which is no luxel.
class SoftPlaceTest : public SoftLuxelTest {
  protected:
    /// Of the first of several turns in which light arrives: of faint lights some shine for all, with a weight.
    SurfaceIncidentLight LightAt(const Vec3f &position, const Vec3f &normal, const Light &light,
                                 const SurfaceLightSettings &settings) {
        const SurfaceCase c(scene_, folder_);
        int culled = 0;
        const std::vector<Light> lights =
            SetupEnvelopes({light}, LightPass::Surfaces, c.settings.light, c.space, {}, culled, false);
        SurfaceReceiverBatch batch;
        batch.Add(position, normal, c.space.ClusterAt(position, 0));
        SurfaceIncidentLight incident;
        ContributionCounts counts;
        turns_ = 0;
        do
            LightContributionToSample(lights.at(0), settings, c.scene, batch, incident, counts);
        while (incident.live[0] == 0 && ++turns_ < 1000);
        return incident;
    }
    int turns_ = 0;
};

TEST_F(SoftPlaceTest, VerticesCloseToThePlaneOfALampAreLitWhereTheyAre) {
    const Light lamp = AreaLight({0, 0, 100}, 96, 96, {0, 0, -1}, 1000);
    const Vec3f p{-60, 0, 99.5f}, n{1, 0, 0};
    const SurfaceIncidentLight incident = LightAt(p, n, lamp, {.areaShadows = 16});
    ASSERT_NE(incident.live[0], 0);
    EXPECT_NEAR(incident.strength[0], 1000 * FormFactor(Vec3d(p), Vec3d(n), std::span<const Vec3f>(lamp.polygon)),
                0.01);
}

TEST_F(SoftPlaceTest, AWeightLeavesDirectionsAsTheyAre) {
    const SurfaceIncidentLight incident =
        LightAt({0, 0, 1}, {0, 0, 1}, AreaLight({100, 0, 200}, 20, 20, {0, 0, -1}, 10),
                {.faint = 0.5f, .directional = true, .areaShadows = 16});
    ASSERT_GT(turns_, 2) << "turns in which others shine for it";
    ASSERT_NE(incident.live[0], 0);
    EXPECT_NEAR(incident.directions.vector[0].z, 1, 1e-4f);
    EXPECT_NEAR(incident.directions.uniform[0], 0, 1e-4f);
}

TEST_F(SoftLuxelTest, FewRaysAreFewRays) {
    scene_.AddBox({-60, -50, 60}, {40, 40, 80}, Shaded("textures/test/wall"));
    const Light lamp = AreaLight({0, 0, 200}, 96, 96, {0, 0, -1}, 1000);
    const auto raysOf = [&](int areaShadows) {
        Bake({lamp}, areaShadows);
        return double(rays_);
    };
    const double one = raysOf(0);
    EXPECT_LT(raysOf(1), 1.05 * one);
    EXPECT_GT(raysOf(16), 1.2 * one);
}

TEST_F(SoftLuxelTest, TheNumberOfThreadsDoesNotMatter) {
    scene_.AddBox({-60, -50, 60}, {40, 40, 80}, Shaded("textures/test/wall"));
    std::vector<Light> lights{AreaLight({0, 0, 200}, 96, 96, {0, 0, -1}, 1000),
                              AreaLight({90, 50, 150}, 30, 20, {0, 0, -1}, 900)};
    scene_.SetWallShader(BoxFace::PlusZ, Shaded("textures/test/sky"));
    for (const Light &sun : Suns(64, 100, true))
        lights.push_back(sun);
    const std::vector<Luxel> one = Bake(lights, 64, 1), more = Bake(lights, 64, 3);
    for (std::size_t i = 0; i < one.size(); ++i)
        ASSERT_EQ(one[i].light, more[i].light);
}

} // namespace

} // namespace q3::test
