// GPL-2.0-or-later. Noise filter of gathered light.
#include "libs/math/sampling.h"
#include "libs/math/vec.h"
#include "q3map2/lightmap/bounce/bounce_filter.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace q3::test {

namespace {

constexpr int kSide = 24;

class FilterTest : public testing::Test {
  protected:
    FilterTest() {
        raw_.width = raw_.height = kSide;
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x)
                raw_.positions.push_back({float(x) * 16, float(y) * 16, 0});
        raw_.normals.assign(raw_.positions.size(), {0, 0, 1});
        raw_.luxelClusters.assign(raw_.positions.size(), 0);
    }
    /// Pseudorandom in +-half, fixed by the luxel.
    static float Noise(std::size_t luxel, float half) {
        return (float(HashIndex(luxel) >> 40) * 0x1p-24f * 2 - 1) * half;
    }
    template <typename Light> std::vector<Vec3f> Filtered(const Light &light, float deviation) const {
        BounceEstimate estimate(raw_, false);
        std::vector<float> luminance;
        for (std::size_t i = 0; i < raw_.positions.size(); ++i) {
            estimate.irradiance[i] = light(int(i % kSide), int(i / kSide));
            luminance.push_back(Luminance(estimate.irradiance[i]));
        }
        NoiseFilter(raw_, luminance, std::vector<float>(luminance.size(), deviation)).Apply(estimate);
        return estimate.irradiance;
    }
    static Vec3f Gray(float x) { return {x, x, x}; }

    RawLightmap raw_;
};

TEST_F(FilterTest, EvenLightLosesItsNoise) {
    const float half = 3;
    const auto light = Filtered([&](int x, int y) { return Gray(40 + Noise(std::size_t(y * kSide + x), half)); },
                                half / std::sqrt(3.0f));
    double sum = 0;
    for (const Vec3f &one : light)
        sum += std::pow(double(one.x) - 40, 2);
    EXPECT_LT(std::sqrt(sum / double(light.size())), 0.35 * std::sqrt(half * half / 3));
}

/// The 16 luxels of a 4 x 4 block use different sets of directions, each with the same weight in the filter's mean.
TEST_F(FilterTest, APatternOfFourLuxelsVanishes) {
    const auto light = Filtered([](int x, int y) { return Gray(float(x % 4) + 4 * float(y % 4)); }, 10);
    for (int y = 2; y < kSide - 2; ++y)
        for (int x = 2; x < kSide - 2; ++x)
            EXPECT_NEAR(light[raw_.Index(x, y)].x, 7.5, 1e-4);
}

TEST_F(FilterTest, AnEdgeStronglyOverTheNoiseStays) {
    const auto light = Filtered([](int x, int) { return Gray(x < kSide / 2 ? 100.0f : 20.0f); }, 1);
    for (std::size_t i = 0; i < light.size(); ++i)
        EXPECT_NEAR(light[i].x, int(i % kSide) < kSide / 2 ? 100 : 20, 1) << i % kSide;
}

TEST_F(FilterTest, LinearGradientsStayUpToTheBorder) {
    const auto ramp = [](int x, int y) { return Gray(100 + 3 * float(x) - 2 * float(y)); };
    const auto light = Filtered(ramp, 1000);
    for (std::size_t i = 0; i < light.size(); ++i)
        EXPECT_NEAR(light[i].x, ramp(int(i % kSide), int(i / kSide)).x, 1e-3);
}

TEST_F(FilterTest, LightWithoutNoiseKeepsItsBits) {
    const auto light = Filtered([](int x, int y) { return Gray(std::sin(float(x * y))); }, 0);
    for (std::size_t i = 0; i < light.size(); ++i)
        EXPECT_EQ(light[i].x, std::sin(float(int(i) % kSide * (int(i) / kSide))));
}

TEST_F(FilterTest, SurfacesAtAnAngleOrAStepAndUnmappedLuxelsDoNotMix) {
    const auto expectApart = [&] {
        const auto light = Filtered([](int x, int) { return Gray(x < kSide / 2 ? 100.0f : 20.0f); }, 1e6);
        for (std::size_t i = 0; i < light.size(); ++i)
            EXPECT_NEAR(light[i].x, int(i % kSide) < kSide / 2 ? 100 : 20, 1e-4);
    };
    const RawLightmap flat = raw_;
    for (std::size_t i = 0; i < raw_.normals.size(); ++i)
        if (int(i % kSide) >= kSide / 2)
            raw_.normals[i] = {1, 0, 0};
    expectApart();
    raw_ = flat;
    for (std::size_t i = 0; i < raw_.normals.size(); ++i)
        if (int(i % kSide) >= kSide / 2)
            raw_.positions[i].z = 64;
    expectApart();
    raw_ = flat;
    for (std::size_t i = 0; i < raw_.normals.size(); ++i)
        if (const int x = int(i % kSide); x == kSide / 2 || x == kSide / 2 + 1 || x == kSide / 2 - 1)
            raw_.luxelClusters[i] = -1;
    expectApart();
}

} // namespace

} // namespace q3::test
