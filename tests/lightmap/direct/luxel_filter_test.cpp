// GPL-2.0-or-later. -filter and filter radii where the lightmaps of a floor meet.
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/lightmap/direct/luxel_light.h"
#include "tests/support/surface_case.h"

#include <cmath>
#include <memory>

#include <fmt/format.h>

namespace q3::test {

namespace {

/// The floor of a room at height 0, in one lightmap or several.
class BlurTest : public testing::Test {
  protected:
    static constexpr std::string_view kWhole = "textures/test/whole";

    BlurTest() {
        lamp_.origin = {20, 8, 60};
        lamp_.photons = 200000;
        settings_.lightmap.filter = true;
    }
    void AddFloor(std::string_view shader, float from, float to) {
        scene_.AddQuad(Rectangle(from, -128, to, 128, 0), Shaded(shader));
    }
    SurfaceLight Lit() {
        case_ = std::make_unique<SurfaceCase>(scene_, folder_, settings_);
        SurfaceLight surfaces = case_->Mapped();
        int culled = 0;
        const std::vector<Light> lights =
            SetupEnvelopes({lamp_}, LightPass::Surfaces, case_->settings.light, case_->space,
                           SkySeenFrom(case_->space, case_->table), culled, true);
        ContributionCounts counts;
        LightLuxels(case_->Inputs(), lights, {}, surfaces, counts);
        return surfaces;
    }
    const RawLightmap &Of(const SurfaceLight &surfaces, std::string_view shader) const {
        return LightmapOf(*case_, surfaces, shader);
    }
    std::size_t Slot(const RawLightmap &raw) const { return FindStyleSlot(raw.styles, std::uint8_t(lamp_.style)); }
    /// The luxel at that place of the floor.
    static std::size_t LuxelAt(const RawLightmap &raw, float x, float y) {
        for (std::size_t i = 0; i < raw.positions.size(); ++i)
            if (raw.Mapped(i) && std::abs(raw.positions[i].x - x) < 0.1f && std::abs(raw.positions[i].y - y) < 0.1f)
                return i;
        throw Error("no luxel at {} {}", x, y);
    }
    float LightAt(const RawLightmap &raw, float x, float y) const { return raw.light[Slot(raw)][LuxelAt(raw, x, y)].x; }
    /// The light of the lamp on the floor at a height of one unit, by its formula.
    double LampAt(double x, double y) const {
        const Vec3d way = Vec3d(lamp_.origin) - Vec3d{x, y, 1};
        return double(lamp_.photons) * way.z / std::pow(Length(way), 3);
    }
    void ExpectSame(const RawLightmap &part, const RawLightmap &whole, float from, float to);
    void ExpectPartsLikeTheWhole(std::initializer_list<float> borders);

    SceneBuilder scene_ = EmptyRoom();
    GameFolder folder_;
    CaseSettings settings_;
    Light lamp_;
    std::unique_ptr<SurfaceCase> case_;
};

/// Compares all values of a part of the floor with those of the whole floor in one lightmap.
void BlurTest::ExpectSame(const RawLightmap &part, const RawLightmap &whole, float from, float to) {
    int looked = 0;
    for (float x = from; x <= to; x += 16)
        for (float y = -96; y <= 96; y += 16) {
            const std::size_t a = LuxelAt(part, x, y), b = LuxelAt(whole, x, y);
            const auto expect = [&](const std::vector<Vec3f> &got, const std::vector<Vec3f> &expected, float within) {
                EXPECT_LT(Length(got[a] - expected[b]), within + 2e-3f * Length(expected[b])) << x << " " << y;
            };
            expect(part.light[Slot(part)], whole.light[Slot(whole)], 1e-3f);
            if (!whole.directions.empty())
                expect(part.directions, whole.directions, 1e-4f);
            ASSERT_EQ(part.channels.Count(), whole.channels.Count());
            for (std::size_t c = 0; c < whole.channels.Count(); ++c)
                expect(part.directional[Slot(part)][c], whole.directional[Slot(whole)][c], 1e-2f);
            ++looked;
        }
    EXPECT_GE(looked, 26);
}

/// borders: x of where lightmaps meet.
void BlurTest::ExpectPartsLikeTheWhole(std::initializer_list<float> borders) {
    AddFloor(kWhole, -128, 128);
    const SurfaceLight one = Lit();
    const RawLightmap whole = Of(one, kWhole);
    scene_ = EmptyRoom();
    std::vector<float> ends{-128};
    ends.insert(ends.end(), borders);
    ends.push_back(128);
    const auto name = [](std::size_t i) { return fmt::format("textures/test/part{}", i); };
    for (std::size_t i = 0; i + 1 < ends.size(); ++i)
        AddFloor(name(i), ends[i], ends[i + 1]);
    const SurfaceLight several = Lit();
    for (std::size_t i = 0; i + 1 < ends.size(); ++i)
        ExpectSame(Of(several, name(i)), whole, ends[i], ends[i + 1]);
}

TEST_F(BlurTest, PartsOfAFloorAreBlurredLikeTheWhole) {
    ExpectPartsLikeTheWhole({0});
}

TEST_F(BlurTest, BoxesReachOverSeveralLightmaps) {
    lamp_.filterRadius = 64;
    ExpectPartsLikeTheWhole({-16, 16});
}

TEST_F(BlurTest, DirectionsChannelsAndStylesCrossTheBorder) {
    settings_.lightmap.deluxe = settings_.lightmap.lightmass = true;
    settings_.lightmap.rnm = settings_.lightmap.rnmAll = true;
    lamp_.style = 5;
    ExpectPartsLikeTheWhole({0});
}

TEST_F(BlurTest, LargerLuxelsAndRadiiOfShadersMakeNoStep) {
    for (const std::string_view line : {"q3map_lightmapSampleSize 32", "q3map_lightmapFilterRadius 64 0"}) {
        scene_ = EmptyRoom();
        settings_.script = fmt::format("{}\n{{\n\t{}\n\t{{\n\t\tmap $whiteimage\n\t}}\n}}\n", kA, line);
        AddFloor(kA, -128, 0);
        AddFloor(kB, 0, 128);
        const SurfaceLight surfaces = Lit();
        for (const float y : {-64.0f, 0.0f, 32.0f}) {
            const float a = LightAt(Of(surfaces, kA), 0, y), b = LightAt(Of(surfaces, kB), 0, y);
            EXPECT_NEAR(a, b, 0.02f * b) << line << " " << y;
        }
    }
}

TEST_F(BlurTest, ANeighborLitAtItsVerticesLeavesGradientsAsTheyAre) {
    settings_.script = fmt::format("{}\n{{\n\tsurfaceparm pointlight\n\t{{\n\t\tmap $whiteimage\n\t}}\n}}\n", kB);
    lamp_.origin = {64, 8, 60};
    AddFloor(kA, -128, 0);
    AddFloor(kB, 0, 128);
    const SurfaceLight surfaces = Lit();
    // Half a box would give the light of 4 units farther from the lamp: an eighth less.
    EXPECT_NEAR(LightAt(Of(surfaces, kA), 0, 0), LampAt(0, 0), 0.05 * LampAt(0, 0));
}

TEST_F(BlurTest, NoLightLeaksThroughAThinWall) {
    scene_.AddBox({-1, -512, -8}, {1, 512, 512}, Shaded("textures/test/slab"), BoxKind::Detail);
    AddFloor(kA, -128, -1);
    AddFloor(kB, 1, 128);
    const SurfaceLight surfaces = Lit();
    const RawLightmap &dark = Of(surfaces, kA);
    for (std::size_t i = 0; i < dark.luxelClusters.size(); ++i)
        if (dark.Mapped(i) && dark.positions[i].x < -2) {
            EXPECT_EQ(dark.light[0][i].x, 0) << dark.positions[i].x;
        }
}

TEST_F(BlurTest, ACurveThatGoesOnFromTheFloorIsAsBrightWhereTheyMeet) {
    lamp_.origin = {60, 8, 120}; // brighter on the curve: half a box would darken the floor by a tenth
    AddFloor(kA, -128, 0);
    std::vector<Vec3f> points;
    for (const float y : {-128.0f, 0.0f, 128.0f})
        for (const Vec3f &p : {Vec3f{0, y, 0}, Vec3f{64, y, 0}, Vec3f{128, y, 64}})
            points.push_back(p);
    scene_.AddPatch(3, 3, points, Shaded(kB));
    const SurfaceLight surfaces = Lit();
    const RawLightmap &floor = Of(surfaces, kA), &curve = Of(surfaces, kB);
    int looked = 0;
    for (std::size_t i = 0; i < curve.positions.size(); ++i)
        if (const Vec3f &p = curve.positions[i]; curve.Mapped(i) && std::abs(p.x) < 0.5f && std::abs(p.y) < 100) {
            const float low = LightAt(floor, 0, std::floor(p.y / 16) * 16),
                        high = LightAt(floor, 0, std::floor(p.y / 16) * 16 + 16);
            EXPECT_GT(curve.light[0][i].x, 0.97f * std::min(low, high)) << p.y;
            EXPECT_LT(curve.light[0][i].x, 1.03f * std::max(low, high)) << p.y;
            ++looked;
        }
    EXPECT_GE(looked, 8);
}

TEST_F(BlurTest, SameLightForAnyNumberOfThreads) {
    AddFloor(kA, -128, 0);
    AddFloor(kB, 0, 128);
    const SurfaceLight one = Lit();
    settings_.threads = 3;
    const SurfaceLight three = Lit();
    ASSERT_EQ(one.lightmaps.size(), three.lightmaps.size());
    for (std::size_t i = 0; i < one.lightmaps.size(); ++i)
        EXPECT_EQ(one.lightmaps[i].light[0], three.lightmaps[i].light[0]);
}

} // namespace

} // namespace q3::test
