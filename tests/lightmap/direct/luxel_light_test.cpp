// GPL-2.0-or-later. Light on luxels: against NetRadiant's q3map2, closed forms and slow code.
#include "common/files/files.h"
#include "q3map2/light/batch/form_factor.h"
#include "q3map2/light/options/light_tone.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/lightmap/direct/luxel_light.h"
#include "tests/lightmap/direct/luxel_vectors.h"
#include "tests/lightmap/direct/test_lights.h"
#include "tests/support/surface_case.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3::test {

namespace {

/// Lights a map by the given lights.
struct Lit {
    Lit(SurfaceCase &c, std::vector<Light> created, const SurfacePass &pass = {}, bool fastPoint = true)
        : surfaces(c.Mapped()) {
        int culled = 0;
        lights = SetupEnvelopes(std::move(created), LightPass::Surfaces, c.settings.light, c.space,
                                SkySeenFrom(c.space, c.table), culled, fastPoint);
        LightLuxels(c.Inputs(), lights, pass, surfaces, counts);
    }
    std::vector<Light> lights;
    SurfaceLight surfaces;
    ContributionCounts counts;
};

/// A floor of 256 x 256 at height 0 in an otherwise unlit room.
class LuxelLightTest : public testing::Test {
  protected:
    static constexpr const char *kFloor = "textures/test/floor";

    SurfaceCase &Case(CaseSettings settings = {}) {
        scene_.AddQuad(Rectangle(-128, -128, 128, 128, 0), Shaded(kFloor));
        case_ = std::make_unique<SurfaceCase>(scene_, folder_, std::move(settings));
        return *case_;
    }
    const RawLightmap &Floor(const Lit &lit) const { return LightmapOf(*case_, lit.surfaces, kFloor); }
    /// Calls check(place, normal, light) for every mapped luxel of the floor.
    template <typename Check> void ForFloor(const Lit &lit, const Check &check) const {
        const RawLightmap &floor = Floor(lit);
        ASSERT_GE(floor.luxelClusters.size(), 200u);
        for (std::size_t i = 0; i < floor.luxelClusters.size(); ++i)
            if (floor.Mapped(i))
                check(floor.positions[i], floor.normals[i], floor.light[0][i]);
    }

    SceneBuilder scene_ = EmptyRoom();
    GameFolder folder_;
    std::unique_ptr<SurfaceCase> case_;
};

TEST_F(LuxelLightTest, PointLightFollowsItsFormula) {
    const Vec3f at{30, -50, 120};
    Light light = PointLight(at, 300 * 7500);
    light.color = {1, 0.5f, 0.25f};
    const Lit lit(Case(), {light});
    ForFloor(lit, [&](const Vec3f &p, const Vec3f &n, const Vec3f &got) {
        const Vec3d way(at - p);
        const double add = 300 * 7500 * Dot(way, Vec3d(n)) / std::pow(Length(way), 3);
        EXPECT_NEAR(got.x, add, 1e-4 * add);
        EXPECT_NEAR(got.y, 0.5 * add, 1e-4 * add);
        EXPECT_NEAR(got.z, 0.25 * add, 1e-4 * add);
    });
}

TEST_F(LuxelLightTest, LightEndsAtTheTolerance) {
    CaseSettings settings;
    settings.light.skip.faint = false;
    // 100 units up: weaker than 1 in the corners. Without the tolerance it goes on.
    const Light light = PointLight({0, 0, 100}, 45000);
    SurfaceCase &c = Case(settings);
    const Lit fast(c, {light}), full(c, {light}, {}, false);
    int ended = 0;
    ForFloor(full, [&](const Vec3f &p, const Vec3f &, const Vec3f &got) {
        const float way = Length(p - light.origin);
        EXPECT_NEAR(got.x, light.photons / (way * way) * (99 / way), 1e-3f) << p.x << " " << p.y;
    });
    const RawLightmap &ending = Floor(fast), &whole = Floor(full);
    for (std::size_t i = 0; i < whole.luxelClusters.size(); ++i) {
        EXPECT_EQ(ending.light[0][i].x, whole.light[0][i].x > 1 ? whole.light[0][i].x : 0);
        ended += whole.light[0][i].x > 0 && whole.light[0][i].x <= 1 ? 1 : 0;
    }
    EXPECT_GT(ended, 0);
}

TEST_F(LuxelLightTest, LightThatIsNotForGridsLightsSurfaces) {
    Light light = PointLight({0, 0, 100}, 100000);
    light.lightsGrid = false;
    const Lit lit(Case(), {light});
    ForFloor(lit, [](const Vec3f &, const Vec3f &, const Vec3f &got) { EXPECT_GT(got.x, 0); });
    light.lightsGrid = true, light.lightsSurfaces = false;
    SurfaceCase &c = *case_;
    ForFloor(Lit(c, {light}), [](const Vec3f &, const Vec3f &, const Vec3f &got) { EXPECT_EQ(got.x, 0); });
}

TEST_F(LuxelLightTest, BlurIsTheMeanOfTheNeighborhood) {
    CaseSettings settings;
    settings.lightmap.filter = true;
    SurfaceCase &c = Case(settings);
    const Light light = PointLight({10, 20, 60}, 200000);
    const Lit blurred(c, {light});
    c.settings.lightmap.filter = false;
    const Lit plain(c, {light});
    const RawLightmap &a = Floor(blurred), &b = Floor(plain);
    int looked = 0;
    for (int y = 1; y + 1 < a.height; ++y)
        for (int x = 1; x + 1 < a.width; ++x) {
            double sum = 0;
            bool all = true;
            for (int oy = -1; oy <= 1; ++oy)
                for (int ox = -1; ox <= 1; ++ox) {
                    const std::size_t at = b.Index(x + ox, y + oy);
                    all = all && b.Mapped(at);
                    sum += b.light[0][at].x * (ox != 0 ? 0.5 : 1) * (oy != 0 ? 0.5 : 1);
                }
            if (!all)
                continue;
            ++looked;
            EXPECT_NEAR(a.light[0][a.Index(x, y)].x, sum / 4, 1e-3 * sum);
        }
    EXPECT_GE(looked, 100);
}

TEST_F(LuxelLightTest, SamplesSmoothTheEdgeOfAShadow) {
    // A slab hides the light from x > 3.7 on: the shadow's edge is parallel to y.
    scene_.AddBox({1.85f, -512, 60}, {512, 512, 70}, Shaded("textures/test/slab"), BoxKind::Detail);
    const Light light = PointLight({0, 0, 120}, 3e6f);
    std::array<double, 3> error{};
    std::array<int, 3> partly{};
    SurfaceCase &c = Case();
    const std::array<int, 3> levels = {1, 2, 4};
    for (std::size_t k = 0; k < levels.size(); ++k) {
        c.settings.lightmap.samples = levels[k];
        const Lit lit(c, {light});
        ForFloor(lit, [&](const Vec3f &p, const Vec3f &, const Vec3f &got) {
            const float way = Length(p - light.origin);
            const float add = light.photons / (way * way) * (119 / way);
            // The edge of the slab is 60 of the 120 units up; rays end one unit above the floor.
            const double edge = 1.85 * 119 / 60, share = std::clamp((edge - (p.x - 8)) / 16, 0.0, 1.0);
            error[k] += std::abs(got.x / add - share);
            partly[k] += got.x > 0.02f * add && got.x < 0.98f * add ? 1 : 0;
        });
    }
    EXPECT_EQ(partly[0], 0);
    EXPECT_GT(partly[1], 10);
    EXPECT_LT(error[1], 0.8 * error[0]);
    EXPECT_LT(error[2], error[1]);
}

TEST_F(LuxelLightTest, RandomSamplesStayBetweenDarkAndLight) {
    scene_.AddBox({1.85f, -512, 60}, {512, 512, 70}, Shaded("textures/test/slab"), BoxKind::Detail);
    CaseSettings settings;
    settings.lightmap.randomSamples = true;
    const Light light = PointLight({0, 0, 120}, 3e6f);
    const Lit lit(Case(settings), {light});
    int partly = 0;
    ForFloor(lit, [&](const Vec3f &p, const Vec3f &, const Vec3f &got) {
        const float way = Length(p - light.origin), add = light.photons / (way * way) * (119 / way);
        // Samples lie within a luxel, 16 units, of the middle in x and y: the nearest of them gets most.
        const float x = std::max(0.f, std::abs(p.x) - 16), y = std::max(0.f, std::abs(p.y) - 16);
        EXPECT_LE(got.x, light.photons * 119 / std::pow(x * x + y * y + 119 * 119, 1.5f) * 1.0001f);
        partly += got.x > 0.02f * add && got.x < 0.9f * add ? 1 : 0;
    });
    EXPECT_GT(partly, 10);
}

TEST_F(LuxelLightTest, StylesTakeSlotsWhereTheyShine) {
    SurfaceCase &c = Case();
    std::vector<Light> lights;
    for (const int style : {0, 7, 3, 9, 12, 5}) {
        // Style 9 is under the floor.
        lights.push_back(PointLight({0, 0, style == 9 ? -100.0f : 100.0f}, 1e5f * float(1 + style)));
        lights.back().style = style;
    }
    const Lit lit(c, lights);
    const RawLightmap &floor = Floor(lit);
    // Of four that shine here besides style 0, the weakest finds no slot.
    EXPECT_EQ(floor.styles, (Styles{0, 5, 7, 12}));
    for (std::size_t slot = 0; slot < kStyles; ++slot) {
        const float expected = floor.light[0][100].x * float(1 + floor.styles[slot]);
        EXPECT_NEAR(floor.light[slot][100].x, expected, 1e-4f * expected);
    }
    EXPECT_THAT(c.quiet.text,
                testing::HasSubstr(
                    "WARNING: light left out where 3 other styles come first: light of style 3 (lightmaps: 1)\n"));
}

TEST_F(LuxelLightTest, StylesThatFindNoSlotAreNamedOnlyIfTheyArrive) {
    for (const bool arrives : {false, true}) {
        scene_ = EmptyRoom();
        SurfaceCase &c = Case();
        std::vector<Light> lights;
        for (const int style : {0, 7, 3, 9, 12}) {
            // Style 12 comes last: from under the floor, or from above.
            lights.push_back(PointLight({0, 0, style == 12 && !arrives ? -20.0f : 100.0f}, 1e5f));
            lights.back().style = style;
        }
        const Lit lit(c, lights);
        EXPECT_EQ(Floor(lit).styles, (Styles{0, 3, 7, 9}));
        // Of equal styles the one with the highest number goes.
        EXPECT_EQ(c.quiet.text.find("left out where 3 other styles come first: light of style 12 (") !=
                      std::string::npos,
                  arrives);
    }
}

TEST_F(LuxelLightTest, DirectionsPointToTheLight) {
    CaseSettings settings;
    settings.lightmap.deluxe = true;
    const Vec3f at{30, -50, 120};
    const Lit lit(Case(settings), {PointLight(at, 1e7f)});
    const RawLightmap &floor = Floor(lit);
    for (std::size_t i = 0; i < floor.luxelClusters.size(); ++i)
        if (floor.Mapped(i)) {
            const Vec3f expected =
                Normalize(at - floor.positions[i]) * (floor.light[0][i].x / 255) + Vec3f{0, 0, 1.0f / 256};
            EXPECT_LT(Length(floor.directions[i] - expected), 1e-4f * Length(expected));
        }
}

TEST_F(LuxelLightTest, ReceiversOfNoShadowsGetTheSun) {
    CaseSettings settings;
    settings.surfaces = "default\n{\nreceiveShadows 0\nsampleSize 16\nlightmapAxis ( 0 0 1 )\n}\n";
    Light sun;
    sun.type = LightType::Sun;
    sun.photons = 100;
    sun.normal = {0, 0, -1};
    const Lit lit(Case(settings), {sun}); // no sky in this map
    ForFloor(lit, [](const Vec3f &, const Vec3f &, const Vec3f &got) { EXPECT_NEAR(got.x, 100, 1e-3); });
}

/// Lights of all kinds over a floor with something on it, where each is checked at each luxel alone.
class LuxelCullTest : public LuxelLightTest {
  protected:
    std::vector<Light> ManyLights(int count) {
        std::mt19937 random(7);
        const auto between = [&](float low, float high) {
            return low + (high - low) * float(random() % 65536) / 65536;
        };
        std::vector<Light> lights;
        for (int i = 0; i < count; ++i) {
            const Vec3f at{between(-300, 300), between(-300, 300), between(-40, 250)};
            if (i % 3 == 0) {
                lights.push_back(PointLight(at, between(1000, 300000)));
                lights.back().twoSided = false;
            } else {
                const float sign = i % 2 == 0 ? 1.0f : -1.0f;
                const Vec3f normal = i % 4 < 2 ? Vec3f{0, 0, sign} : Vec3f{sign, 0, 0};
                lights.push_back(AreaLight(at, between(4, 120), between(4, 120), normal, between(1, 400)));
                lights.back().twoSided = i % 5 == 0;
            }
        }
        return lights;
    }
    SceneBuilder &Obstacles() {
        scene_.AddBox({20, 20, 10}, {60, 60, 50}, Shaded("textures/test/box"), BoxKind::Detail);
        return scene_;
    }
    /// Largest difference from every light at every luxel by itself: what leaving lights out by blocks costs. The light
    /// of one sample has its closed forms in the tests above and in FormFactors.
    double LargestDifference(SurfaceCase &c, const Lit &lit) {
        const RawLightmap &floor = Floor(lit);
        double largest = 0;
        for (std::size_t i = 0; i < floor.luxelClusters.size(); ++i) {
            if (!floor.Mapped(i))
                continue;
            double sum = 0;
            for (const Light &light : lit.lights) {
                SurfaceReceiverBatch one;
                one.Add(floor.positions[i], floor.normals[i], floor.luxelClusters[i]);
                SurfaceIncidentLight incident;
                ContributionCounts counts;
                LightContributionToSample(light, {}, c.scene, one, incident, counts);
                sum += incident.live[0] != 0 ? double(incident.strength[0]) : 0;
            }
            largest = std::max(largest, std::abs(sum - double(floor.light[0][i].x)));
        }
        return largest;
    }
};

TEST_F(LuxelCullTest, NothingThatShinesIsLeftOut) {
    Obstacles();
    CaseSettings settings;
    settings.light.skip.faint = false;
    SurfaceCase &c = Case(settings);
    for (const bool fast : {false, true}) {
        c.settings.light.fast = fast;
        const Lit lit(c, ManyLights(150));
        EXPECT_GT(lit.counts.rays, 1000u);
        EXPECT_LT(LargestDifference(c, lit), 0.02);
    }
}

TEST_F(LuxelCullTest, FaintLightsAreRepresentedByOthers) {
    Obstacles();
    SurfaceCase &c = Case();
    const Lit lit(c, ManyLights(300));
    EXPECT_GT(lit.counts.skippedFaint, 100u);
    EXPECT_LT(LargestDifference(c, lit), 0.5);
}

TEST_F(LuxelCullTest, ThreadsChangeNothing) {
    Obstacles();
    CaseSettings settings;
    settings.lightmap.samples = 2;
    SurfaceCase &c = Case(settings);
    const Lit one(c, ManyLights(60));
    c.jobs = JobPool(3);
    const Lit three(c, ManyLights(60));
    ASSERT_EQ(one.surfaces.lightmaps.size(), three.surfaces.lightmaps.size());
    for (std::size_t i = 0; i < one.surfaces.lightmaps.size(); ++i)
        EXPECT_EQ(one.surfaces.lightmaps[i].light[0], three.surfaces.lightmaps[i].light[0]);
    EXPECT_EQ(one.counts.rays, three.counts.rays);
}

TEST(FormFactors, AgreeWithTheSlowOnes) {
    std::mt19937 random(3);
    const auto number = [&] { return float(random() % 20001) / 10 - 1000; };
    const auto place = [&] { return Vec3f{number(), number(), number()}; };
    for (int round = 0; round < 200; ++round) {
        const Vec3f center = place(), x = Normalize(place()) * std::abs(number()), y = place() * 0.2f;
        const Winding<float> w = {center, center + x, center + x + y, center + y * 0.7f};
        Lanes3 p, n;
        for (std::size_t i = 0; i < kPacketSize; ++i)
            p.Set(i, place()), n.Set(i, Normalize(place()));
        Lanes f;
        FormFactors(p, n, w, f);
        for (std::size_t i = 0; i < kPacketSize; ++i)
            EXPECT_NEAR(double(f[i]), FormFactor(Vec3d(p[i]), Vec3d(n[i]), w), 2e-5) << round;
    }
}

TEST(FormFactors, OfADiscAboveItsCenterIsItsClosedForm) {
    // A regular polygon of 64 corners that looks down from height h.
    for (const double h : {10.0, 80.0, 640.0}) {
        Winding<float> w;
        constexpr int kCorners = 64;
        for (int i = 0; i < kCorners; ++i) {
            const double a = 2 * std::numbers::pi * i / kCorners;
            w.push_back({float(100 * std::cos(a)), float(100 * std::sin(a)), float(h)});
        }
        Lanes3 p{}, n;
        n.Fill({0, 0, 1});
        Lanes f;
        FormFactors(p, n, w, f);
        // sin^2 of the half angle, a shade less for the polygon.
        EXPECT_NEAR(std::abs(f[0]), 100 * 100 / (100 * 100 + h * h), 0.003);
    }
}

/// A map of the test vectors of NetRadiant's q3map2.
class LuxelVectorTest : public testing::TestWithParam<LuxelVector> {};

TEST_P(LuxelVectorTest, GivesTheSameBytes) {
    const LuxelVector &vector = GetParam();
    const std::string data = TEST_DATA "/vectors", map = data + "/maps/" + vector.map;
    std::istringstream in(vector.options);
    std::vector<std::string> words{std::istream_iterator<std::string>(in), {}};
    Arguments arguments(words);
    KeptLog quiet;
    const Game &game = *FindGame("quake3");
    const LightOptions options = ParseLightOptions(arguments, game, quiet.log);
    const LightmapOptions lightmap = ParseLightmapOptions(arguments, options, game, quiet.log);
    VirtualFileSystem vfs(quiet.log);
    vfs.Mount(data + "/baseq3", "pk3");
    ShaderLibrary library(vfs, game, options.shader, quiet.log);
    const Bsp bsp = ReadBspFile(map + ".bsp", {}, quiet.log);
    const LightInputs inputs{vector.name, ParseMapEntities(ReadTextFile(map + ".map"), map),
                             ReadTextFile(map + ".srf")};
    SurfaceDefaults defaults;
    defaults.sampleSize = lightmap.sampleSize;
    const LightSetup setup(bsp, inputs, options, defaults, library, quiet.log);
    const JobPool jobs(1);
    const SurfaceInputs all{setup.bsp, setup.space, setup.scene, setup.table, setup.options,
                            lightmap,  setup.world, jobs,        quiet.log};
    SurfaceLight surfaces = SetupSurfaceLight(all);
    MapLuxels(all, surfaces);
    int culled = 0;
    const std::vector<Light> lights =
        SetupEnvelopes(setup.lights, LightPass::Surfaces, options, setup.space, setup.skySeenFrom, culled);
    ContributionCounts counts;
    LightLuxels(all, lights, {}, surfaces, counts);
    for (const ExpectedLuxel &expected : vector.luxels) {
        const Vec3f place(expected.place), normal(expected.normal);
        bool found = false;
        for (const RawLightmap &raw : surfaces.lightmaps)
            for (std::size_t i = 0; i < raw.luxelClusters.size() && !found; ++i) {
                if (!raw.Mapped(i) || Length(raw.positions[i] - place) > 0.2f || Dot(raw.normals[i], normal) < 0.9f)
                    continue;
                found = true;
                const auto got = ColorToBytes(raw.light[0][i], 1, raw.brightness, setup.options.tone);
                for (std::size_t k = 0; k < 3; ++k)
                    EXPECT_NEAR(int(got[k]), expected.rgb[k], 1) << place.x << " " << place.y << " " << place.z;
            }
        EXPECT_TRUE(found) << place.x << " " << place.y << " " << place.z;
    }
}

INSTANTIATE_TEST_SUITE_P(Reference, LuxelVectorTest, testing::ValuesIn(LuxelVectors()),
                         [](const auto &test) { return std::string(test.param.name); });

} // namespace

} // namespace q3::test
