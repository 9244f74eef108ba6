// GPL-2.0-or-later. Minimaps: samples of a pixel, level curves, options.
#include "common/error.h"
#include "q3map2/minimap/minimap.h"
#include "tests/minimap/minimap_fixture.h"

#include <gmock/gmock.h>

#include <cmath>

namespace q3::test {

namespace {

using testing::ElementsAre;
using testing::FloatNear;

std::vector<float> Leveled(int size, std::vector<float> values, MinimapOptions options) {
    KeptLog quiet;
    MinimapValues image{size, std::move(values)};
    ApplyMinimapLevels(image, options, quiet.log);
    return image.values;
}

/// Without sharpening.
MinimapOptions Plain() {
    MinimapOptions options;
    options.sharpen = -1;
    return options;
}

MinimapOptions Parsed(std::vector<std::string> words) {
    KeptLog quiet;
    Arguments arguments(std::move(words));
    return ParseMinimapOptions(arguments, quiet.log);
}

double LeastWrappedDistance(const std::vector<PixelOffset> &points) {
    double least = 1;
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            for (const double dx : {-1.0, 0.0, 1.0})
                for (const double dy : {-1.0, 0.0, 1.0})
                    least =
                        std::min(least, std::hypot(points[i][0] - points[k][0] + dx, points[i][1] - points[k][1] + dy));
    return least;
}

TEST(MinimapSamples, AreSpread) {
    for (const std::size_t count : {2u, 5u, 16u, 64u}) {
        const auto points = SpreadOffsets(count);
        ASSERT_EQ(points.size(), count);
        for (const PixelOffset &p : points)
            EXPECT_TRUE(p[0] >= 0 && p[0] < 1 && p[1] >= 0 && p[1] < 1);
        // No points are farther apart than those of a triangular lattice.
        const double lattice = std::sqrt(2 / (std::sqrt(3) * double(count)));
        EXPECT_GT(LeastWrappedDistance(points), 0.6 * lattice) << count;
        EXPECT_EQ(points, SpreadOffsets(count));
    }
}

TEST_F(MinimapTest, FixedSamplesAreAveraged) {
    AddBox({0, 0, 0}, {32, 128, 128}); // half of the left pixel
    options.samples = 64;
    const auto values = Values(2);
    EXPECT_NEAR(values[0], 0.25, 0.03);
    EXPECT_EQ(values[0], values[2]);
    EXPECT_EQ(values[1], 0);
}

TEST_F(MinimapTest, RandomSamplesReachAPixelFromTheMiddle) {
    AddBox({-64, -64, 0}, {64, 192, 256});
    options.randomSamples = 1024;
    options.box = Boundsd{{0, 0, 0}, {128, 128, 256}};
    const auto values = Values(2);
    // The part of a unit disc beyond a chord half a radius from its middle: 1/3 - sqrt(3)/(4 pi).
    const double segment = 1.0 / 3 - std::sqrt(3) / (4 * M_PI);
    EXPECT_NEAR(values[0], 1 - segment, 0.05);
    EXPECT_NEAR(values[1], segment, 0.05);
}

TEST(MinimapLevels, BoostIsAHyperbola) {
    MinimapOptions options = Plain();
    options.boost = 3;
    // v 3 / (2 v + 1)
    EXPECT_THAT(Leveled(2, {0, 0.25f, 0.5f, 1}, options),
                ElementsAre(0, FloatNear(0.5f, 1e-6f), FloatNear(0.75f, 1e-6f), 1));
}

TEST(MinimapLevels, ContrastThenBrightness) {
    MinimapOptions options = Plain();
    options.contrast = 2;
    options.brightness = 0.125;
    EXPECT_THAT(Leveled(2, {0, 0.25f, 0.5f, 1}, options), ElementsAre(0.125f, 0.625f, 1.125f, 2.125f));
}

TEST(MinimapLevels, AutoLevelStretchesToOne) {
    MinimapOptions options = Plain();
    options.autoLevel = true;
    EXPECT_THAT(Leveled(2, {0.25f, 0.5f, 0.75f, 0.5f}, options), ElementsAre(0, 0.5f, 1, 0.5f));
    options.contrast = 0.5;
    options.brightness = 0.25;
    EXPECT_THAT(Leveled(2, {0.25f, 0.5f, 0.75f, 0.5f}, options), ElementsAre(0.25f, 0.5f, 0.75f, 0.5f));
}

TEST(MinimapLevels, SharpeningKeepsFlatPartsAndDarkensWhatIsOutside) {
    MinimapOptions options;
    options.sharpen = 0.5;
    const auto values = Leveled(3, std::vector<float>(9, 0.5f), options);
    EXPECT_FLOAT_EQ(values[4], 0.5f) << "eight neighbors like itself";
    EXPECT_FLOAT_EQ(values[1], 0.5f * (1 + 0.5f * 3)) << "three are outside";
    EXPECT_FLOAT_EQ(values[0], 0.5f * (1 + 0.5f * 5)) << "five are outside";
}

TEST(MinimapLevels, BytesAreClamped) {
    const std::vector<float> values{-1, 0, 0.5f, 0.9999f, 1, 7};
    EXPECT_THAT(MinimapBytes(values), ElementsAre(0, 0, 128, 255, 255, 255));
}

TEST(MinimapOptions, AreTaken) {
    const MinimapOptions options =
        Parsed({"-size",  "64",     "-minmax",       "1",          "2",        "3",  "4",  "5",
                "6",      "-black", "-nokeepaspect", "-autolevel", "-samples", "4",  "-o", "a.tga",
                "-boost", "2",      "-sharpen",      "-1",         "-border",  "0.1"});
    EXPECT_EQ(options.size, 64);
    EXPECT_EQ(options.box->mins, Vec3d(1, 2, 3));
    EXPECT_EQ(options.box->maxs, Vec3d(4, 5, 6));
    EXPECT_TRUE(options.black);
    EXPECT_FALSE(options.keepAspect);
    EXPECT_TRUE(options.autoLevel);
    EXPECT_EQ(options.samples, 4);
    EXPECT_EQ(options.output, "a.tga");
    EXPECT_EQ(options.sharpen, -1);
}

TEST(MinimapOptions, ThatContradictAreErrors) {
    EXPECT_THROW(Parsed({"-gray", "-white"}), Error);
    EXPECT_THROW(Parsed({"-samples", "4", "-random", "4"}), Error);
    EXPECT_THROW(Parsed({"-minmax", "1", "2", "3", "0", "5", "6"}), Error);
    EXPECT_THROW(Parsed({"-border", "0.5"}), Error);
    EXPECT_THROW(Parsed({"-size", "0"}), Error);
}

} // namespace

} // namespace q3::test
