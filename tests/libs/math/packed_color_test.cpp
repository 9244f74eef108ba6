// GPL-2.0-or-later. HDR colors in four bytes.
#include "libs/math/packed_color.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace q3 {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// An encoding, as a round trip.
struct Encoding {
    std::string name;
    std::function<Vec3f(const Vec3f &)> roundTrip;
    int bits;       ///< of a mantissa
    double least;   ///< smallest value with a mantissa of full length
    double quantum; ///< below that
    float maximum;
};

const Encoding kE5bgr9{
    "E5BGR9", [](const Vec3f &c) { return DecodeE5bgr9(EncodeE5bgr9(c)); }, 9, std::ldexp(1.0, -16), 0x1p-24, 65408.0f};
const Encoding kRgbe{"RGBE",   [](const Vec3f &c) { return DecodeRgbe(EncodeRgbe(c)); },
                     8,        std::ldexp(1.0, -128),
                     0x1p-135, 255 * 0x1p119f};
const Encoding kExp32{"ColorRGBExp32",
                      [](const Vec3f &c) { return DecodeRgbExp32(EncodeRgbExp32(c)); },
                      8,
                      std::ldexp(1.0, -121) / 255,
                      std::ldexp(1.0, -128) / 255,
                      0x1p127f};

/// A step of 1.00013: codes are at most 2^-9 apart, so each is met several times.
template <typename Visit> void ForLogSweep(const Visit &visit) {
    for (double value = 1e-6; value < 6e4; value *= 1.00013)
        visit(float(value));
}

class PackedColorTest : public testing::TestWithParam<Encoding> {};

TEST_P(PackedColorTest, LargestChannelIsWithinHalfAStep) {
    const Encoding &encoding = GetParam();
    double worst = 0;
    ForLogSweep([&](float value) {
        for (std::size_t channel = 0; channel < 3; ++channel) {
            Vec3f color(value * 0.3f, value * 0.3f, value * 0.3f);
            color[channel] = value;
            const double error = std::abs(double(encoding.roundTrip(color)[channel]) - double(value));
            const double bound =
                double(value) < encoding.least ? encoding.quantum / 2 : std::ldexp(double(value), -encoding.bits);
            // Half an ulp of float: thirds of ColorRGBExp32 are not exact.
            ASSERT_LE(error, bound + double(value) * 0x1p-24) << value;
            if (double(value) >= encoding.least)
                worst = std::max(worst, error / double(value));
        }
    });
    EXPECT_GT(worst, 0.9 * std::ldexp(1.0, -encoding.bits)) << "the bound is not slack";
}

TEST_P(PackedColorTest, SmallerChannelsAreWithinHalfAStepOfTheLargest) {
    const Encoding &encoding = GetParam();
    ForLogSweep([&](float value) {
        const Vec3f color(999.9f, value, 0), back = encoding.roundTrip(color);
        const double bound = std::ldexp(double(std::max(back.x, back.y)), -encoding.bits);
        ASSERT_LE(std::abs(double(back.x) - double(color.x)), bound) << value;
        ASSERT_LE(std::abs(double(back.y) - double(value)), bound) << value;
        ASSERT_EQ(back.z, 0);
    });
}

TEST_P(PackedColorTest, GrowsWithEachChannel) {
    const Encoding &encoding = GetParam();
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (const float others : {0.0f, 1e-3f, 1.0f, 3000.0f}) {
            float last = -1;
            ForLogSweep([&](float value) {
                Vec3f color(others, others, others);
                color[channel] = value;
                const float back = encoding.roundTrip(color)[channel];
                ASSERT_GE(back, last) << value;
                last = back;
            });
        }
}

TEST_P(PackedColorTest, ExactValues) {
    const Encoding &encoding = GetParam();
    for (const Vec3f color : {Vec3f(0, 0, 0), Vec3f(1, 1, 1), Vec3f(4, 4, 4), Vec3f(4, 0, 0), Vec3f(0, 1, 0)})
        EXPECT_EQ(encoding.roundTrip(color), color) << color.x << " " << color.y << " " << color.z;
}

TEST_P(PackedColorTest, BadAndExcessiveChannels) {
    const Encoding &encoding = GetParam();
    const float most = encoding.maximum;
    EXPECT_EQ(encoding.roundTrip({-1, kNan, -kInfinity}), Vec3f(0, 0, 0));
    EXPECT_EQ(encoding.roundTrip({-1, kNan, 1}), Vec3f(0, 0, 1));
    EXPECT_EQ(encoding.roundTrip({kInfinity, 0, 0}), Vec3f(most, 0, 0));
    EXPECT_EQ(encoding.roundTrip({most, most, most}), Vec3f(most, most, most));
    EXPECT_EQ(encoding.roundTrip({std::nextafter(most, kInfinity), 0, std::numeric_limits<float>::max()}),
              Vec3f(most, 0, most));
    EXPECT_EQ(encoding.roundTrip({1e-45f, 0, 0}), Vec3f(0, 0, 0));
}

TEST_P(PackedColorTest, RoundTripIsStable) {
    const Encoding &encoding = GetParam();
    ForLogSweep([&](float value) {
        const Vec3f once = encoding.roundTrip({value, 0.7f * value, 0.01f * value});
        ASSERT_EQ(encoding.roundTrip(once), once) << value;
    });
}

INSTANTIATE_TEST_SUITE_P(Encodings, PackedColorTest, testing::Values(kE5bgr9, kRgbe, kExp32),
                         [](const auto &param) { return param.param.name; });

TEST(E5bgr9Test, EveryNormalizedCodeComesBack) {
    for (std::uint32_t exponent = 0; exponent < 32; ++exponent)
        for (std::uint32_t mantissa = 0; mantissa < 512; ++mantissa)
            for (std::uint32_t channel = 0; channel < 3; ++channel) {
                // The largest mantissa is in one channel, the others hold any two.
                const std::uint32_t largest = 256 + (mantissa * 7 + exponent) % 256;
                const std::uint32_t shifts[3] = {9 * channel, 9 * ((channel + 1) % 3), 9 * ((channel + 2) % 3)};
                const std::uint32_t code =
                    largest << shifts[0] | mantissa << shifts[1] | (511 - mantissa) << shifts[2] | exponent << 27;
                ASSERT_EQ(EncodeE5bgr9(DecodeE5bgr9(code)), code);
            }
    for (std::uint32_t code = 1; code < 512; ++code) // the least exponent goes without a top bit
        ASSERT_EQ(EncodeE5bgr9(DecodeE5bgr9(code << 9)), code << 9);
}

TEST(E5bgr9Test, Codes) {
    EXPECT_EQ(EncodeE5bgr9({1, 0, 0}), 256u | 16u << 27);
    EXPECT_EQ(EncodeE5bgr9({0, 1, 0}), 256u << 9 | 16u << 27);
    EXPECT_EQ(EncodeE5bgr9({0, 0, 4}), 256u << 18 | 18u << 27);
    EXPECT_EQ(EncodeE5bgr9({65408, 65408, 65408}), 0xFFFFFFFFu);
    EXPECT_EQ(EncodeE5bgr9({0x1p-24f, 0, 0}), 1u);
    // 511.5 / 256 rounds up to 512 / 256, which the next exponent holds.
    EXPECT_EQ(EncodeE5bgr9({511.5f / 256, 511.5f / 512, 0}), 256u | 128u << 9 | 17u << 27);
    EXPECT_EQ(DecodeE5bgr9(1u | 2u << 9 | 3u << 18 | 24u << 27), Vec3f(1, 2, 3));
    const std::vector<Vec3f> colors = {{1, 0, 0}, {0, 0, 4}};
    const std::vector<std::uint32_t> codes = {256u | 16u << 27, 256u << 18 | 18u << 27};
    EXPECT_EQ(EncodeE5bgr9(colors), codes);
    EXPECT_EQ(DecodeE5bgr9(codes), colors);
}

TEST(RgbeTest, Codes) {
    EXPECT_EQ(EncodeRgbe({1, 0.5f, 0}), (Rgbe{128, 64, 0, 129}));
    EXPECT_EQ(EncodeRgbe({0, 0, 4}), (Rgbe{0, 0, 128, 131}));
    EXPECT_EQ(EncodeRgbe({1.999f, 0, 0}), (Rgbe{128, 0, 0, 130})) << "255.872 rounds up to 256";
    EXPECT_EQ(EncodeRgbe({}), (Rgbe{0, 0, 0, 0}));
    EXPECT_EQ(DecodeRgbe({255, 255, 255, 0}), Vec3f(0, 0, 0));
}

TEST(RgbExp32Test, Codes) {
    EXPECT_EQ(EncodeRgbExp32({1, 0, 0}), (ColorRgbExp32{255, 0, 0, 0}));
    EXPECT_EQ(EncodeRgbExp32({4, 2, 1}), (ColorRgbExp32{255, 128, 64, 2}));
    EXPECT_EQ(EncodeRgbExp32({0, 0, 1.0f / 255}), (ColorRgbExp32{0, 0, 128, -7}));
    EXPECT_EQ(DecodeRgbExp32({255, 51, 0, 2}), Vec3f(4, 0.8f, 0));
}

} // namespace
} // namespace q3
