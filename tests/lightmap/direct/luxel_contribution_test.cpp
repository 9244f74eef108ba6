// GPL-2.0-or-later. Directional channels of luxel light: L1 SH and the RNM basis.
#include "q3map2/lightmap/raw/lightmaps.h"

#include "q3map2/light/sources/light_sources.h"
#include "q3map2/lightmap/ao/luxel_occlusion.h"
#include "q3map2/lightmap/bounce/light_bounce.h"
#include "q3map2/lightmap/direct/lightmap_average.h"
#include "q3map2/lightmap/direct/luxel_light.h"
#include "tests/lightmap/direct/test_lights.h"
#include "tests/support/surface_case.h"

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

namespace q3::test {

namespace {

constexpr float kPi = std::numbers::pi_v<float>, kY0 = 0.28209479f, kY1 = 0.48860251f;
constexpr const char *kFloor = "textures/test/floor";

Light PointAt(const Vec3f &at, float photons) {
    Light light;
    light.origin = at;
    light.photons = photons;
    return light;
}

/// The channels of one luxel by name.
struct Channels {
    Vec3f flat;
    std::array<Vec3f, 4> sh;
    BasisNormals basis;

    /// The vector of band 1 of red, per unit of directed light.
    Vec3f Vector() const { return Vec3f{sh[3].x, sh[1].x, sh[2].x} / (kPi * kY1); }
};

/// A floor of 256 x 256 at height 0 in an otherwise unlit room, with all channels.
class DirectionalTest : public testing::Test {
  protected:
    DirectionalTest() { settings_.lightmap.lightmass = settings_.lightmap.rnm = settings_.lightmap.rnmAll = true; }

    SurfaceCase &Case() {
        scene_.AddQuad(Rectangle(-128, -128, 128, 128, 0), Shaded(kFloor));
        case_ = std::make_unique<SurfaceCase>(scene_, folder_, settings_);
        return *case_;
    }

    /// Lights the floor by `lights`.
    const RawLightmap &Lit(std::vector<Light> lights, const SurfacePass &pass = {}) {
        SurfaceCase &c = case_ ? *case_ : Case();
        surfaces_ = c.Mapped();
        FloodLuxels(c.Inputs(), surfaces_);
        int culled = 0;
        const std::vector<Light> ready = SetupEnvelopes(std::move(lights), LightPass::Surfaces, c.settings.light,
                                                        c.space, SkySeenFrom(c.space, c.table), culled);
        ContributionCounts counts;
        LightLuxels(c.Inputs(), ready, pass, surfaces_, counts);
        FinishLuxels(c.Inputs(), pass, surfaces_);
        return LightmapOf(c, surfaces_, kFloor);
    }

    static Channels ChannelsOf(const RawLightmap &raw, std::size_t luxel) {
        Channels all;
        all.flat = raw.light[0][luxel];
        for (std::size_t c = 0; c < 4; ++c)
            all.sh[c] = raw.directional[0][c][luxel];
        for (std::size_t c = 0; c < 3; ++c)
            all.basis[c] = raw.directional[0][4 + c][luxel];
        return all;
    }

    static void ForMapped(const RawLightmap &raw, const std::function<void(std::size_t)> &check) {
        std::size_t count = 0;
        for (std::size_t i = 0; i < raw.luxelClusters.size(); ++i)
            if (raw.Mapped(i))
                check(i), ++count;
        EXPECT_GT(count, 100u);
    }

    /// Expects the channels of light c from w at a luxel.
    static void ExpectDirected(const RawLightmap &raw, std::size_t luxel, const Vec3f &c, const Vec3f &w) {
        const Channels got = ChannelsOf(raw, luxel);
        const float within = 2e-5f * MaxComponent(c) + 1e-4f;
        ExpectVector(got.flat, c * std::max(0.0f, w.z), within);
        ExpectVector(got.sh[0], c * (kPi * kY0), within);
        ExpectVector(got.sh[1], c * (kPi * kY1 * w.y), within);
        ExpectVector(got.sh[2], c * (kPi * kY1 * w.z), within);
        ExpectVector(got.sh[3], c * (kPi * kY1 * w.x), within);
        const BasisNormals basis = raw.BasisOf(luxel);
        for (std::size_t i = 0; i < 3; ++i)
            ExpectVector(got.basis[i], c * std::max(0.0f, Dot(basis[i], w)), within);
    }

    GameFolder folder_;
    CaseSettings settings_;
    SceneBuilder scene_ = EmptyRoom();
    std::unique_ptr<SurfaceCase> case_;
    SurfaceLight surfaces_;
};

TEST(BasisNormals, AreThoseOfTheFormatInTheFrameOfTheTexture) {
    const Vec3f normal = Normalize(Vec3f{1, 2, 3}), t = Normalize(Cross(normal, Vec3f{0, 0, 1})), s = Cross(t, normal);
    for (const float side : {1.0f, -1.0f}) {
        const BasisNormals basis = BasisNormalsOf(normal, {s * 3 + normal, side});
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < 3; ++k)
                EXPECT_NEAR(Dot(basis[i], basis[k]), i == k ? 1 : 0, 1e-6);
        const Vec3f along = s * side; // s x t' points to the normal for t' = t, away for a mirrored t' = -t
        EXPECT_NEAR(Dot(basis[0], s), 0.81649658f, 1e-6);
        EXPECT_NEAR(Dot(basis[1], Cross(normal, along)), 0.70710678f, 1e-6);
        EXPECT_NEAR(Dot(basis[2], Cross(normal, along)), -0.70710678f, 1e-6);
        for (const Vec3f &b : basis)
            EXPECT_NEAR(Dot(b, normal), 0.57735027f, 1e-6);
    }
}

TEST_F(DirectionalTest, PointLight) {
    const Vec3f at{30, -50, 120}, color{1, 0.5f, 0.25f};
    Light light = PointAt(at, 1e6f);
    light.color = color;
    const RawLightmap &floor = Lit({light});
    ForMapped(floor, [&](std::size_t i) {
        const Vec3f to = at - floor.positions[i];
        ExpectDirected(floor, i, color * (1e6f / Dot(to, to)), Normalize(to));
    });
}

TEST_F(DirectionalTest, SunOfEachAxisHasTheSignOfTheBasis) {
    settings_.surfaces = "default\n{\nreceiveShadows 0\nsampleSize 16\nlightmapAxis ( 0 0 1 )\n}\n";
    for (const Vec3f &toward : {Vec3f{0, 0, 1}, Normalize(Vec3f{4, 0, 1}), Normalize(Vec3f{0, 4, 1})}) {
        Light sun;
        sun.type = LightType::Sun;
        sun.photons = 100;
        sun.normal = -toward;
        const RawLightmap &floor = Lit({sun});
        ForMapped(floor, [&](std::size_t i) { ExpectDirected(floor, i, {100, 100, 100}, toward); });
    }
}

/// Light that the cosine law does not explain is the same for all normals.
TEST_F(DirectionalTest, HalfLambertLightIsPartlyUniform) {
    settings_.lightmap.halfLambert = true;
    const Vec3f at{90, 0, 40};
    const RawLightmap &floor = Lit({PointAt(at, 1e6f)});
    ForMapped(floor, [&](std::size_t i) {
        const Vec3f to = at - floor.positions[i], w = Normalize(to);
        const float full = 1e6f / Dot(to, to), wrapped = 0.5f * w.z + 0.5f;
        const float flat = full * wrapped * wrapped, uniform = flat - full * w.z;
        const Channels got = ChannelsOf(floor, i);
        EXPECT_NEAR(got.flat.x, flat, 1e-4f * full);
        EXPECT_NEAR(got.sh[0].x, full * kPi * kY0 + uniform / kY0, 1e-4f * full);
        ExpectVector(got.Vector(), w * full, 1e-4f * full);
        EXPECT_NEAR(got.basis[0].x, full * std::max(0.0f, Dot(floor.BasisOf(i)[0], w)) + uniform, 1e-4f * full);
    });
}

/// Against sums over small pieces of the emitter.
TEST_F(DirectionalTest, AreaLight) {
    const Vec3f center{20, 0, 80};
    constexpr float kWidth = 96, kRadiosity = 400;
    const Light light = AreaLight(center, kWidth, kWidth, {0, 0, -1}, kRadiosity);
    const RawLightmap &floor = Lit({light});
    ForMapped(floor, [&](std::size_t i) {
        constexpr int kSteps = 48;
        Vec3d vector;
        double fluence = 0;
        std::array<double, 3> onBasis{};
        const BasisNormals basis = floor.BasisOf(i);
        for (int v = 0; v < kSteps; ++v)
            for (int u = 0; u < kSteps; ++u) {
                const float step = kWidth / kSteps;
                const Vec3f at =
                    center + Vec3f{(float(u) + 0.5f) * step - kWidth / 2, (float(v) + 0.5f) * step - kWidth / 2, 0};
                const Vec3f to = at - floor.positions[i];
                const double distance = Length(to), cosine = double(to.z) / distance;
                const double weight = kRadiosity / double(kPi) * double(step * step) * cosine / (distance * distance);
                vector += Vec3d(to) * (weight / distance), fluence += weight;
                for (std::size_t k = 0; k < 3; ++k)
                    onBasis[k] += weight * std::max(0.0, double(Dot(basis[k], to)) / distance);
            }
        const Channels got = ChannelsOf(floor, i);
        const float scale = float(fluence);
        EXPECT_NEAR(got.flat.x, float(vector.z), 0.003f * scale);
        ExpectVector(got.Vector(), Vec3f(vector), 0.003f * scale);
        EXPECT_NEAR(got.sh[0].x / (kPi * kY0), scale, 0.02f * scale);
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_NEAR(got.basis[k].x, float(onBasis[k]), 0.015f * scale);
    });
}

TEST_F(DirectionalTest, AmbientIsUniform) {
    scene_.SetWorldKey("ambient", "20");
    scene_.SetWorldKey("_color", "1 0.5 0.25");
    const RawLightmap &floor = Lit({});
    ForMapped(floor, [&](std::size_t i) {
        const Channels got = ChannelsOf(floor, i);
        EXPECT_GT(got.flat.x, 1);
        ExpectVector(got.sh[0], got.flat / kY0);
        ExpectVector(got.Vector(), {});
        for (const Vec3f &light : got.basis)
            ExpectVector(light, got.flat);
    });
}

/// In the open, floodlight has its mean direction along the normal, and its component there is the flat value.
TEST_F(DirectionalTest, Floodlight) {
    scene_ = EmptyRoom({-4096, -4096, -64}, {4096, 4096, 4096});
    scene_.SetWorldKey("_floodlight", "255 255 255 500 100");
    const RawLightmap &floor = Lit({});
    ForMapped(floor, [&](std::size_t i) {
        const Channels got = ChannelsOf(floor, i);
        EXPECT_NEAR(got.flat.x, 100, 1);
        ExpectVector(got.Vector(), {0, 0, got.flat.x}, 1);
        EXPECT_GT(got.sh[0].x / (kPi * kY0), got.flat.x);
        EXPECT_NEAR(got.basis[1].x, got.basis[2].x, 2);
    });
}

/// Under a wall that hides half of the sky, floodlight comes from the open half.
TEST_F(DirectionalTest, FloodlightComesFromTheOpenSide) {
    scene_ = EmptyRoom({-4096, -4096, -64}, {4096, 4096, 4096});
    scene_.SetWorldKey("_floodlight", "255 255 255 500 100");
    scene_.AddBox({-160, -1024, 0}, {-128, 1024, 1024}, Shaded("textures/test/wall"));
    const RawLightmap &floor = Lit({});
    ForMapped(floor, [&](std::size_t i) {
        if (floor.positions[i].x > -110)
            return;
        const Channels got = ChannelsOf(floor, i);
        EXPECT_GT(got.Vector().x, 0.25f * got.flat.x) << floor.positions[i].x;
        EXPECT_NEAR(got.Vector().z, got.flat.x, 1);
    });
}

TEST_F(DirectionalTest, LightsAddUp) {
    const Light a = PointAt({60, 20, 90}, 4e5f), b = PointAt({-80, 70, 30}, 2e5f);
    const RawLightmap one = Lit({a}), other = Lit({b}), both = Lit({a, b});
    ForMapped(both, [&](std::size_t i) {
        for (std::size_t c = 0; c < both.channels.Count(); ++c)
            ExpectVector(both.directional[0][c][i], one.directional[0][c][i] + other.directional[0][c][i], 1e-3f);
    });
}

/// In the penumbra of -samples and of -filter, all channels fade like the flat light.
TEST_F(DirectionalTest, PartialVisibilityReachesAllChannels) {
    for (const bool filter : {false, true}) {
        case_.reset();
        scene_ = EmptyRoom();
        settings_.lightmap.samples = filter ? 1 : 4;
        settings_.lightmap.filter = filter;
        const Vec3f at{2000, 0, 3000};
        scene_ = EmptyRoom({-4096, -4096, -64}, {4096, 4096, 4096});
        scene_.AddBox({-8, -64, 96}, {8, 64, 112}, Shaded("textures/test/wall"));
        const RawLightmap &floor = Lit({PointAt(at, 2e9f)});
        int partial = 0;
        ForMapped(floor, [&](std::size_t i) {
            const Vec3f to = at - floor.positions[i], w = Normalize(to);
            const float full = 2e9f / Dot(to, to), share = ChannelsOf(floor, i).flat.x / (full * w.z);
            partial += share > 0.05f && share < 0.95f;
            const Channels got = ChannelsOf(floor, i);
            EXPECT_NEAR(got.sh[0].x, share * full * kPi * kY0, 0.01f * full);
            ExpectVector(got.Vector(), w * (full * share), 0.01f * full);
            for (std::size_t k = 0; k < 3; ++k)
                EXPECT_NEAR(got.basis[k].x, share * full * std::max(0.0f, Dot(floor.BasisOf(i)[k], w)), 0.01f * full);
        });
        EXPECT_GT(partial, 2) << filter;
    }
}

/// Whatever the gathered light is, the irradiance vector along the normal is the flat light.
TEST_F(DirectionalTest, BouncedLightReachesAllChannels) {
    settings_.lightmap.bounces = 1;
    scene_ = EmptyRoom({-160, -160, -64}, {160, 160, 200});
    const Light light = PointAt({100, 20, 100}, 1e6f);
    Lit({light});
    const SurfaceInputs in = case_->Inputs();
    surfaces_.vertex.styles.assign(in.bsp.drawSurfaces.size(), kOnlyStyle0);
    AverageLuxels(in, {}, PassData::Keep, surfaces_);
    Bounces bounces(in, surfaces_);
    ASSERT_TRUE(bounces.Solve(surfaces_));
    ContributionCounts counts;
    LightLuxels(in, {}, {.bounce = true}, surfaces_, counts);
    bounces.AddToLuxels(surfaces_);
    const RawLightmap &floor = LightmapOf(*case_, surfaces_, kFloor);
    float across = 0;
    ForMapped(floor, [&](std::size_t i) {
        const Channels got = ChannelsOf(floor, i);
        EXPECT_GT(got.flat.x, 1);
        EXPECT_NEAR(got.Vector().z, got.flat.x, 0.02f * got.flat.x);
        EXPECT_GT(got.sh[0].x / (kPi * kY0), got.Vector().z);
        EXPECT_LT(got.sh[0].x / (kPi * kY0), 4 * got.Vector().z);
        across += got.Vector().x / got.flat.x;
        Vec3f fromBasis;
        for (std::size_t k = 0; k < 3; ++k)
            fromBasis += floor.BasisOf(i)[k] * got.basis[k].x;
        EXPECT_GT(Dot(fromBasis, floor.normals[i]), 0.99f * got.Vector().z); // clamped parts add to it
    });
    EXPECT_GT(across, 0); // the wall at x = 160 is the brightest
}

/// A texture turned by 90 degrees, and a mirrored one, turn and mirror the basis.
TEST_F(DirectionalTest, BasisFollowsTheTexture) {
    SurfaceCase &c = Case();
    const Light light = PointAt({80, 30, 60}, 1e6f);
    const bspDrawSurface_t &surface = c.bsp.drawSurfaces[std::size_t(SurfacesOf(c, kFloor).at(0))];
    const auto map = [&](auto st) {
        for (int v = surface.firstVert; v < surface.firstVert + surface.numVerts; ++v) {
            const Vec3f at{c.bsp.drawVerts[std::size_t(v)].xyz[0], c.bsp.drawVerts[std::size_t(v)].xyz[1], 0};
            c.bsp.drawVerts[std::size_t(v)].st = st(at / 128);
        }
        return Lit({light});
    };
    using St = std::array<float, 2>;
    struct Mapping {
        std::function<St(const Vec3f &)> st;
        Vec3f s, t;
    };
    const Mapping mappings[] = {{[](const Vec3f &p) {
                                     return St{p.x, -p.y};
                                 },
                                 {1, 0, 0},
                                 {0, -1, 0}},
                                {[](const Vec3f &p) {
                                     return St{p.y, p.x};
                                 },
                                 {0, 1, 0},
                                 {1, 0, 0}},
                                {[](const Vec3f &p) {
                                     return St{-p.x, -p.y};
                                 },
                                 {-1, 0, 0},
                                 {0, -1, 0}}};
    for (const Mapping &mapping : mappings) {
        const RawLightmap floor = map(mapping.st);
        ForMapped(floor, [&](std::size_t i) {
            const Vec3f to = Vec3f{80, 30, 60} - floor.positions[i];
            const Vec3f w = Normalize(to), local{Dot(w, mapping.s), Dot(w, mapping.t), w.z};
            const Vec3f expected[] = {{0.81649658f, 0, 0.57735027f},
                                      {-0.40824829f, 0.70710678f, 0.57735027f},
                                      {-0.40824829f, -0.70710678f, 0.57735027f}};
            for (std::size_t k = 0; k < 3; ++k)
                EXPECT_NEAR(ChannelsOf(floor, i).basis[k].x,
                            1e6f / Dot(to, to) * std::max(0.0f, Dot(expected[k], local)), 0.01f);
        });
    }
}

TEST_F(DirectionalTest, OffKeepsNothing) {
    settings_.lightmap.lightmass = settings_.lightmap.rnm = settings_.lightmap.rnmAll = false;
    const RawLightmap &floor = Lit({PointAt({0, 0, 100}, 1e6f)});
    EXPECT_TRUE(floor.directional[0].empty());
    EXPECT_TRUE(floor.tangents.empty());
}

} // namespace

} // namespace q3::test
