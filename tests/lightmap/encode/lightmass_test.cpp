// GPL-2.0-or-later. Lightmaps in the layout of Lightmass: encoder and decoder.
#include "libs/directional/directional.h"
#include "q3map2/lightmap/encode/directional_encode.h"
#include "tests/lightmap/encode/light_sets.h"

#include <functional>

#include <gtest/gtest.h>

namespace q3::test {

namespace {

using namespace lightmass;

constexpr Vec3f kUp{0, 0, 1};

GatheredLuxel Gathered(const std::vector<Lamp> &lamps, const Vec3f &normal = kUp) {
    GatheredLuxel luxel;
    L1Light l1;
    for (const Lamp &lamp : lamps)
        l1.AddLight(lamp.color, lamp.direction);
    luxel.high.AddL1(l1, Received(lamps, normal), normal);
    luxel.low = luxel.high;
    luxel.normal = normal;
    luxel.mapped = true;
    return luxel;
}

std::vector<LuxelLight> Converted(const std::vector<GatheredLuxel> &luxels) {
    std::vector<LuxelLight> out;
    out.reserve(luxels.size());
    for (const GatheredLuxel &luxel : luxels)
        out.push_back(ToCoefficients(luxel));
    return out;
}

Lightmap Row(const std::vector<GatheredLuxel> &luxels, const QuantizeOptions &options = {}) {
    return Quantize(int(luxels.size()), 1, Converted(luxels), options);
}

directional_range RangeOf(const Lightmap &map, std::size_t image) {
    directional_range range;
    for (std::size_t k = 0; k < 2; k++)
        for (std::size_t i = 0; i < 4; i++) {
            range.multiply[k][i] = map.range.multiply[image + k][i];
            range.add[k][i] = map.range.add[image + k][i];
        }
    return range;
}

/// Decoded from texels of both images, 0 to 1. `normal` may be null.
Vec3f FromTexels(const Lightmap &map, const float color[4], const float direction[4], std::size_t image,
                 const float *normal) {
    const directional_range range = RangeOf(map, image);
    float rgb[3];
    (image == kHigh ? directional_lightmass_high : directional_lightmass_low)(color, direction, &range, normal, rgb);
    return {rgb[0], rgb[1], rgb[2]};
}

Vec3f DecodedLuxel(const Lightmap &map, std::size_t i, const Vec3f &normal, std::size_t image = kHigh) {
    float color[4], direction[4];
    directional_texel(map.luxels[i].coefficients[image].data(), color);
    directional_texel(map.luxels[i].coefficients[image + 1].data(), direction);
    const float n[3] = {normal.x, normal.y, normal.z};
    return FromTexels(map, color, direction, image, n);
}

double RelativeError(float got, float expected, float black) {
    return std::abs(double(got) - expected) / (double(expected) + black);
}

/// decode(n) of the coefficients before they are quantised.
Vec3f DecodedCoefficients(const LuxelLight &luxel, const Vec3f &n, std::size_t image = kHigh) {
    const Vec3f d = luxel.coefficients[image + 1];
    return luxel.coefficients[image] * std::max(0.0f, 0.282095f + d.x * n.y + d.y * n.z + d.z * n.x);
}

TEST(LightmassCoefficients, DecodeAtTheSmoothNormalIsTheIncidentLight) {
    LightSets sets(1);
    for (int i = 0; i < 1000; i++) {
        const Vec3f normal = sets.Direction();
        const auto lamps = sets.Lamps(normal);
        const LuxelLight luxel = ToCoefficients(Gathered(lamps, normal));
        const Vec3f expected = Received(lamps, normal);
        for (const std::size_t image : {kHigh, kLow})
            for (std::size_t c = 0; c < 3; c++)
                EXPECT_NEAR(DecodedCoefficients(luxel, normal, image)[c], expected[c], 1e-5 * (1 + expected[c]));
    }
}

TEST(LightmassCoefficients, OneLight) {
    // Direction of one light: 0.325735 sqrt(3) = 0.564190 along it, in the order y, z, x.
    const Vec3f axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const std::size_t slots[3] = {2, 0, 1};
    for (std::size_t axis = 0; axis < 3; axis++) {
        const LuxelLight luxel = ToCoefficients(Gathered({{{1, 1, 1}, axes[axis]}}, axes[axis]));
        for (std::size_t k = 0; k < 3; k++)
            EXPECT_NEAR(luxel.coefficients[kHigh + 1][k], k == slots[axis] ? 0.564190 : 0, 1e-6);
        EXPECT_NEAR(luxel.coefficients[kHigh].x, 1 / (0.282095 + 0.564190), 1e-5);
    }
}

TEST(LightmassCoefficients, LightsFromBehindKeepTheLevel) {
    // Light from behind is part of the direction; without its guard the factor at the normal would be negative here.
    const LuxelLight luxel = ToCoefficients(Gathered({{{1, 1, 1}, {0, 0, -1}}, {{0.1f, 0.1f, 0.1f}, kUp}}));
    EXPECT_NEAR(DecodedCoefficients(luxel, kUp).x, 0.1, 1e-6);
    EXPECT_LE(luxel.coefficients[kHigh].x, 0.1f / (0.282095f / 4) + 1e-5f);
}

TEST(LightmassCoefficients, DarkAndDamagedLight) {
    const LuxelLight dark = ToCoefficients(Gathered({}));
    EXPECT_EQ(dark.coefficients[kHigh], Vec3f{});
    EXPECT_EQ(dark.coefficients[kHigh + 1], Vec3f{});
    GatheredLuxel damaged = Gathered({{{1, 1, 1}, kUp}});
    damaged.high.incident = {std::nanf(""), -1, 1};
    damaged.high.l1Luminance = std::nanf("");
    const LuxelLight luxel = ToCoefficients(damaged);
    EXPECT_NEAR(DecodedCoefficients(luxel, kUp).z, 1, 1e-6);
    EXPECT_EQ(luxel.coefficients[kHigh].x, 0);
    EXPECT_EQ(luxel.coefficients[kHigh].y, 0);
}

TEST(LightmassCoefficients, GatheredLightIsAdditive) {
    LightSets sets(2);
    const auto a = sets.Lamps(kUp), b = sets.Lamps(kUp);
    auto both = a;
    both.insert(both.end(), b.begin(), b.end());
    GatheredLight sum = Gathered(a).high;
    sum += Gathered(b).high;
    GatheredLight expected = Gathered(both).high;
    sum *= 0.5f, expected *= 0.5f;
    EXPECT_NEAR(sum.l1Luminance, expected.l1Luminance, 1e-5);
    for (std::size_t c = 0; c < 3; c++)
        EXPECT_NEAR(sum.incident[c], expected.incident[c], 1e-5);
    EXPECT_NEAR(sum.incident.x, Received(both, kUp).x / 2, 1e-5);
}

TEST(LightmassBytes, LightAlongTheNormalWithin16Bits) {
    // A row of lights of 2^-6 .. 2^5 along the normal. ln 2 * 11.5 / 65535 = 1.2e-4 above the black point.
    std::vector<GatheredLuxel> luxels;
    std::vector<float> lit;
    for (int i = 0; i < 500; i++) {
        lit.push_back(std::exp2(-6 + 11 * float(i) / 499));
        luxels.push_back(Gathered({{{lit.back(), lit.back(), lit.back()}, kUp}}));
    }
    const Lightmap map = Row(luxels);
    for (std::size_t i = 0; i < lit.size(); i++)
        EXPECT_LT(RelativeError(DecodedLuxel(map, i, kUp).x, lit[i], kHighLog.black), 1.2e-4) << lit[i];
    // 8 bits: ln 2 * 16 / 255 / 2 = 2.2 %.
    for (std::size_t i = 0; i < lit.size(); i++)
        EXPECT_LT(RelativeError(DecodedLuxel(map, i, kUp, kLow).x, lit[i], kLowLog.black), 0.022) << lit[i];
}

TEST(LightmassBytes, LuminanceAtTheSmoothNormalWithin16BitsOnRandomLamps) {
    LightSets sets(3);
    std::vector<GatheredLuxel> luxels;
    std::vector<float> lit;
    for (int i = 0; i < 1000; i++) {
        const Vec3f normal = sets.Direction();
        const auto lamps = sets.Lamps(normal);
        luxels.push_back(Gathered(lamps, normal));
        lit.push_back(DirectionalLuminance(Received(lamps, normal)));
    }
    const Lightmap map = Row(luxels);
    for (std::size_t i = 0; i < luxels.size(); i++)
        EXPECT_LT(RelativeError(DirectionalLuminance(DecodedLuxel(map, i, luxels[i].normal)), lit[i], kHighLog.black),
                  1.2e-4);
}

TEST(LightmassBytes, NeverNegative) {
    LightSets sets(4);
    std::vector<GatheredLuxel> luxels;
    for (int i = 0; i < 200; i++)
        luxels.push_back(Gathered({{{1, 0.5f, 0.1f}, sets.DirectionAbove(kUp)}}));
    const Lightmap map = Row(luxels);
    for (std::size_t i = 0; i < luxels.size(); i++)
        for (const std::size_t image : {kHigh, kLow}) {
            const Vec3f back = -Vec3f{luxels[i].high.l1.c[3].x, luxels[i].high.l1.c[1].x, luxels[i].high.l1.c[2].x};
            const Vec3f opposite = DecodedLuxel(map, i, Normalize(back), image);
            EXPECT_EQ(opposite.x, 0);
            EXPECT_EQ(opposite.z, 0);
            const Vec3f any = DecodedLuxel(map, i, sets.Direction(), image);
            EXPECT_GE(any.x, 0);
            EXPECT_GE(any.y, 0);
            EXPECT_GE(any.z, 0);
        }
}

TEST(LightmassBytes, ColorHasNoDirection) {
    // Red from the left, blue from the right: every normal sees the color of the sum. A limit of the layout.
    const Lightmap map = Row({Gathered({{{1, 0, 0}, Tilted(60)}, {{0, 0, 1}, Tilted(60, 180)}})});
    const Vec3f left = DecodedLuxel(map, 0, Tilted(60)), right = DecodedLuxel(map, 0, Tilted(60, 180));
    EXPECT_NEAR(left.z / left.x, 1, 0.02);
    EXPECT_NEAR(right.z / right.x, 1, 0.02);
    EXPECT_GT(left.x, right.x); // red is more luminous, so its side is
}

TEST(LightmassBytes, EqualLuxelsHaveNoRange) {
    const auto lamp = Gathered({{{0.25f, 0.5f, 0.75f}, Tilted(20)}});
    const Lightmap map = Row({lamp, lamp, lamp});
    for (std::size_t image = 0; image < kImages; image++)
        for (std::size_t i = 0; i < 4; i++) {
            EXPECT_EQ(map.range.multiply[image][i], 0);
            EXPECT_TRUE(std::isfinite(map.range.add[image][i]));
        }
    EXPECT_NEAR(map.range.add[1][3], 0.282095, 1e-6);
    EXPECT_NEAR(map.range.add[3][3], 0.282095, 1e-6);
    const Vec3f expected = Received({{{0.25f, 0.5f, 0.75f}, Tilted(20)}}, kUp);
    for (const std::size_t image : {kHigh, kLow})
        for (std::size_t c = 0; c < 3; c++)
            EXPECT_NEAR(DecodedLuxel(map, 1, kUp, image)[c], expected[c], 1e-5);
}

TEST(LightmassBytes, DarkMapsAndEmptyMaps) {
    const Lightmap dark = Row({Gathered({}), Gathered({})});
    EXPECT_EQ(DecodedLuxel(dark, 0, kUp), Vec3f{});
    EXPECT_EQ(DecodedLuxel(dark, 1, kUp, kLow), Vec3f{});
    const Lightmap none = Quantize(2, 1, std::vector<LuxelLight>(2));
    EXPECT_EQ(none.luxels[0], LuxelBytes{});
    EXPECT_EQ(none.range.multiply[0][0], 0);
    EXPECT_EQ(none.range.add[0][3], 0);
    EXPECT_TRUE(Quantize(0, 0, std::span<const LuxelLight>{}).luxels.empty());
}

TEST(LightmassBytes, LuxelsOffSurfacesDoNotCount) {
    GatheredLuxel off = Gathered({{{50, 0, 0}, kUp}});
    off.mapped = false;
    const auto on = Gathered({{{0.5f, 0.5f, 0.5f}, kUp}});
    const Lightmap map = Row({on, off, on});
    EXPECT_EQ(map.luxels[1], LuxelBytes{});
    EXPECT_EQ(map.luxels[0].coverage, 255);
    EXPECT_EQ(map.range.multiply[0][3], 0);
}

TEST(LightmassBytes, InfiniteAndBlindingLight) {
    GatheredLuxel broken = Gathered({{{1, 1, 1}, kUp}}), bright = Gathered({{{1000, 1000, 1000}, kUp}});
    broken.high.incident.x = std::numeric_limits<float>::infinity();
    const Lightmap map = Row({broken, bright, Gathered({{{1, 1, 1}, kUp}})});
    for (std::size_t i = 0; i < 3; i++)
        EXPECT_TRUE(IsFinite(DecodedLuxel(map, i, kUp)));
    // The end of the range: 2^5.75 - 2^-5.75, times the factor of the direction.
    EXPECT_NEAR(DecodedLuxel(map, 1, kUp).y, (std::exp2(5.75) - std::exp2(-5.75)) * 0.846284, 0.05);
    EXPECT_NEAR(DecodedLuxel(map, 2, kUp).y, 1, 2e-4);
}

TEST(LightmassBytes, RampIsMonotonic) {
    // 256 luxels from dark to 2, light of one color that turns over the wall.
    std::vector<GatheredLuxel> luxels;
    for (int i = 0; i < 256; i++) {
        const float value = 2 * float(i) / 255 / std::cos(float(i) / 255 * 1.2f);
        luxels.push_back(Gathered({{Vec3f{1, 0.8f, 0.5f} * value, Tilted(double(i) / 255 * 1.2 * 57.29578)}}));
    }
    const Lightmap map = Row(luxels), unrepaired = Row(luxels, {false, false});
    int falls = 0;
    for (std::size_t i = 1; i < 256; i++) {
        EXPECT_GT(DecodedLuxel(map, i, kUp).x, DecodedLuxel(map, i - 1, kUp).x) << i;
        falls += DecodedLuxel(unrepaired, i, kUp).x <= DecodedLuxel(unrepaired, i - 1, kUp).x;
    }
    std::vector<GatheredLuxel> straight;
    for (int i = 0; i < 256; i++)
        straight.push_back(Gathered({{Vec3f{1, 0.8f, 0.5f} * (float(i) / 255), Tilted(30)}}));
    const Lightmap plain = Row(straight);
    for (std::size_t i = 1; i < 256; i++) {
        EXPECT_GT(DecodedLuxel(plain, i, kUp).x, DecodedLuxel(plain, i - 1, kUp).x) << i;
        EXPECT_GE(DecodedLuxel(plain, i, kUp, kLow).x, DecodedLuxel(plain, i - 1, kUp, kLow).x) << i;
    }
    RecordProperty("falls without the folds", falls);
}

TEST(LightmassBytes, FilteredLogIsDarkerThanFilteredLight) {
    // Half way between luxels of 1 and 1 / 64: filtered light is 0.508; filtered logs give the geometric mean of what
    // is stored, 0.163. A limit of the layout.
    const Lightmap map = Row({Gathered({{{1, 1, 1}, kUp}}), Gathered({{{1 / 64.0f, 1 / 64.0f, 1 / 64.0f}, kUp}})});
    float color[2][4], direction[2][4], mid[2][4];
    const float n[3] = {0, 0, 1};
    for (std::size_t i = 0; i < 2; i++) {
        directional_texel(map.luxels[i].coefficients[kHigh].data(), color[i]);
        directional_texel(map.luxels[i].coefficients[kHigh + 1].data(), direction[i]);
    }
    for (std::size_t c = 0; c < 4; c++) {
        mid[0][c] = (color[0][c] + color[1][c]) / 2;
        mid[1][c] = (direction[0][c] + direction[1][c]) / 2;
    }
    const double factor = 0.282095 + 0.564190, black = kHighLog.black;
    const double logs = (std::sqrt((1 / factor + black) * (1 / 64.0 / factor + black)) - black) * factor;
    EXPECT_NEAR(FromTexels(map, mid[0], mid[1], kHigh, n).x, logs, 1e-3 * logs);
    EXPECT_NEAR(logs, 0.1627, 1e-4);
    EXPECT_NEAR((1 + 1 / 64.0) / 2, 0.5078, 1e-4);
}

TEST(LightmassBytes, WithoutDirectionTheFactorIsConstant) {
    const Lightmap map = Row({Gathered({{{1, 1, 1}, kUp}})});
    float color[4], direction[4];
    directional_texel(map.luxels[0].coefficients[kHigh].data(), color);
    directional_texel(map.luxels[0].coefficients[kHigh + 1].data(), direction);
    EXPECT_NEAR(FromTexels(map, color, direction, kHigh, nullptr).x, 0.6 / (0.282095 + 0.564190), 1e-4);
}

TEST(LightmassBytes, OcclusionIsStoredAsRoots) {
    GatheredLuxel luxel = Gathered({{{1, 1, 1}, kUp}});
    luxel.high.skyOcclusion = Vec3f{0.6f, 0, 0.8f} * 0.25f;
    luxel.high.unoccluded = 0.04f;
    const Lightmap map = Row({luxel, Gathered({})});
    EXPECT_TRUE(map.hasSkyOcclusion);
    EXPECT_EQ(map.luxels[0].skyOcclusion[3], 128); // sqrt(0.25) * 255 = 127.5
    EXPECT_EQ(map.luxels[0].unoccluded, 51);       // sqrt(0.04) * 255
    EXPECT_NEAR(directional_unoccluded(map.luxels[0].unoccluded / 255.0f), 0.04, 1e-6);
    float texel[4], sky[3];
    directional_texel(map.luxels[0].skyOcclusion.data(), texel);
    directional_sky_occlusion(texel, sky);
    EXPECT_NEAR(sky[0], 0.15, 0.002);
    EXPECT_NEAR(sky[1], 0, 0.002);
    EXPECT_NEAR(sky[2], 0.2, 0.002);
    directional_texel(map.luxels[1].skyOcclusion.data(), texel);
    directional_sky_occlusion(texel, sky);
    EXPECT_EQ(sky[2], 0);
    EXPECT_FALSE(Row({Gathered({})}).hasSkyOcclusion);
}

TEST(LightmassVisibility, BytesAndCoverage) {
    const std::vector<Visibility> samples{{0, true}, {1, true}, {0.5f, true}, {2, true}, {-1, true}, {1, false}};
    const VisibilityMap map = Quantize(6, 1, samples);
    const std::vector<VisibilityBytes> expected{{0, 255}, {255, 255}, {128, 255}, {255, 255}, {0, 255}, {0, 0}};
    EXPECT_EQ(map.luxels, expected);
    EXPECT_EQ(map.width, 6);
}

/// Root mean square, over luxels, of the relative error of luminance at the smooth normal and of color at the smooth
/// normal and 30 degrees beside it.
struct FoldError {
    double luminance = 0, color = 0;
};

FoldError ErrorOf(const std::vector<GatheredLuxel> &luxels, std::size_t image, const QuantizeOptions &options) {
    const auto exact = Converted(luxels);
    const Lightmap map = Quantize(int(luxels.size()), 1, exact, options);
    FoldError error;
    int colors = 0;
    for (std::size_t i = 0; i < luxels.size(); i++) {
        const Vec3f n = luxels[i].normal, s = Normalize(Cross(n, Vec3f{0.36f, 0.48f, 0.8f}));
        const float black = image == kHigh ? kHighLog.black : kLowLog.black;
        for (const Vec3f &at : {n, Normalize(n + s * 0.57735f), Normalize(n - s * 0.57735f)}) {
            const Vec3f want = DecodedCoefficients(exact[i], at, image), got = DecodedLuxel(map, i, at, image);
            for (std::size_t c = 0; c < 3; c++, colors++)
                error.color += std::pow(double(got[c] - want[c]) / (DirectionalLuminance(want) + black), 2);
        }
        const float want = DirectionalLuminance(DecodedCoefficients(exact[i], n, image));
        error.luminance +=
            std::pow(RelativeError(DirectionalLuminance(DecodedLuxel(map, i, n, image)), want, black), 2);
    }
    return {std::sqrt(error.luminance / double(luxels.size())), std::sqrt(error.color / colors)};
}

std::vector<GatheredLuxel> RandomLuxels() {
    LightSets sets(10);
    std::vector<GatheredLuxel> luxels;
    for (int i = 0; i < 4096; i++) {
        const Vec3f normal = sets.Direction();
        luxels.push_back(Gathered(sets.Lamps(normal), normal));
    }
    return luxels;
}

/// A wall of 64 x 64 luxels with a warm and a cold lamp before it.
std::vector<GatheredLuxel> WallLuxels() {
    std::vector<GatheredLuxel> luxels;
    for (int y = 0; y < 64; y++)
        for (int x = 0; x < 64; x++) {
            std::vector<Lamp> lamps;
            for (const auto &[at, color] : {std::pair{Vec3f{12, 20, 8}, Vec3f{200, 140, 60}},
                                            std::pair{Vec3f{50, 44, 14}, Vec3f{80, 120, 400}}}) {
                const Vec3f to = at - Vec3f{float(x), float(y), 0};
                lamps.push_back({color * (1 / Dot(to, to)), Normalize(to)});
            }
            luxels.push_back(Gathered(lamps));
        }
    return luxels;
}

TEST(LightmassFolds, RepairLuminanceAtTheSmoothNormal) {
    for (const auto &luxels : {RandomLuxels(), WallLuxels()}) {
        const FoldError none = ErrorOf(luxels, kHigh, {false, false}), color = ErrorOf(luxels, kHigh, {false, true}),
                        direction = ErrorOf(luxels, kHigh, {true, false}), both = ErrorOf(luxels, kHigh, {});
        EXPECT_LT(color.luminance, 0.95 * none.luminance);
        EXPECT_LT(direction.luminance, 0.7 * none.luminance);
        EXPECT_LT(both.luminance, none.luminance / 50);
        EXPECT_LT(color.color, 0.95 * none.color);
        EXPECT_LT(direction.color, 0.95 * none.color);
        EXPECT_LT(both.color, 0.8 * none.color);
    }
}

TEST(LightmassFolds, DoNoHarmToOneByteOfLuminance) {
    for (const auto &luxels : {RandomLuxels(), WallLuxels()}) {
        const FoldError none = ErrorOf(luxels, kLow, {false, false}), both = ErrorOf(luxels, kLow, {});
        EXPECT_LT(both.luminance, none.luminance);
        EXPECT_LT(both.color, none.color);
    }
}

} // namespace

} // namespace q3::test
