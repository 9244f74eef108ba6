// GPL-2.0-or-later. Directional light of luxels as stored: L1 spherical harmonics, radiosity normal mapping, the layout
// of Lightmass.
#include "q3map2/lightmap/encode/directional_encode.h"
#include "libs/math/elementary.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace q3 {

// ---- Directional light as stored: L1 spherical harmonics, and radiosity normal mapping ----

namespace {

/// Not below zero; NaN gives 0.
float LightOrZero(float value) {
    return value > 0 ? value : 0;
}

using ChannelOfMaps = std::array<float, 3>; ///< one color channel of the three maps

ChannelOfMaps RescaledChannel(ChannelOfMaps maps, float flat) {
    flat = LightOrZero(flat);
    double sum = 0;
    for (float &value : maps) {
        value = LightOrZero(value);
        sum += value;
    }
    if (!(sum > 0))
        return {flat, flat, flat};
    for (float &value : maps)
        value = float(value / sum * 3 * flat);
    return maps;
}

/// The largest value gives its excess over 1 to both others, then the middle one to the smallest. Values still above 1,
/// which need a mean above 1, are clamped.
ChannelOfMaps OverflowedChannel(const ChannelOfMaps &maps) {
    std::array<std::size_t, 3> order{0, 1, 2};
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return maps[a] > maps[b]; });
    ChannelOfMaps out = maps;
    float &first = out[order[0]], &second = out[order[1]], &third = out[order[2]];
    const float fromFirst = std::max(0.0f, first - 1) / 2;
    second += fromFirst, third += fromFirst;
    third += std::max(0.0f, second - 1);
    for (float &value : out)
        value = std::min(value, 1.0f);
    return out;
}

template <typename Change> RnmLight ByChannel(const RnmLight &light, Change change) {
    RnmLight out;
    for (std::size_t channel = 0; channel < 3; channel++) {
        const ChannelOfMaps values =
            change({light.map[0][channel], light.map[1][channel], light.map[2][channel]}, channel);
        for (std::size_t i = 0; i < 3; i++)
            out.map[i][channel] = values[i];
    }
    return out;
}

} // namespace

RnmLight RescaleToFlat(const RnmLight &raw, const Vec3f &flat) {
    return ByChannel(
        raw, [&](const ChannelOfMaps &maps, std::size_t channel) { return RescaledChannel(maps, flat[channel]); });
}

RnmLight OverflowToOthers(const RnmLight &light) {
    return ByChannel(light, [](const ChannelOfMaps &maps, std::size_t) { return OverflowedChannel(maps); });
}

} // namespace q3

namespace q3::lightmass {

// ---- Lightmaps in the layout of Unreal's Lightmass ----

namespace {

constexpr float kLongestDirection = 0.564190f;      // of one light: sqrt(3) kL1Directed
constexpr float kLeastDirectionality = kL1Flat / 4; // at the smooth normal
constexpr float kBrightest = 1e9f;                  // infinite light counts as this (chosen)
constexpr float kDark = 1e-12f;                     // light with an L0 up to this has no direction
constexpr float kColorlessLuminance = 1e-4f;        // below it light counts as white

/// Finite, and not below 0. NaN gives 0.
float NotNegative(float value) {
    return value > 0 ? std::min(value, kBrightest) : 0;
}

Vec3f NotNegative(const Vec3f &v) {
    return {NotNegative(v.x), NotNegative(v.y), NotNegative(v.z)};
}

std::uint8_t UnitByte(float value) {
    return std::uint8_t(std::lround(std::clamp(NotNegative(value), 0.0f, 1.0f) * 255));
}

/// The axes of a normal in the order of the direction's coefficients.
Vec3f SHOrder(const Vec3f &n) {
    return {n.y, n.z, n.x};
}

struct ColorAndDirection {
    Vec3f color, direction;
};

ColorAndDirection Coefficients(const GatheredLight &light) {
    const auto [l0, y, z, x] = light.l1.Luminance();
    const Vec3f incident = NotNegative(light.incident);
    if (!(l0 > kDark))
        return {incident * (1 / kL1Flat), {}};
    const Vec3f direction = Vec3f{y, z, x} * (kL1Directed / l0);
    // The direction's part of the value at the normal: l1Luminance = l0 (kL1Flat + directed).
    const float directed = light.l1Luminance / l0 - kL1Flat;
    if (!IsFinite(direction) || !std::isfinite(directed))
        return {incident * (1 / kL1Flat), {}};
    float shorter = std::min(1.0f, kLongestDirection / std::max(Length(direction), kLongestDirection));
    if (kL1Flat + shorter * directed < kLeastDirectionality)
        shorter = (kLeastDirectionality - kL1Flat) / directed;
    return {incident * (1 / (kL1Flat + shorter * directed)), direction * shorter};
}

/// Smallest and largest value of a coefficient, and the bytes between them.
class Range {
  public:
    void Add(float value) { low_ = std::min(low_, value), high_ = std::max(high_, value); }
    float Multiply() const { return high_ > low_ ? high_ - low_ : 0; }
    float Offset() const { return high_ >= low_ ? low_ : 0; }
    /// The byte for a value before rounding, 0 to 255.
    float UnroundedByte(float value) const {
        return Multiply() > 0 ? std::clamp((value - low_) / Multiply(), 0.0f, 1.0f) * 255 : 0;
    }
    std::uint8_t Byte(float value) const { return std::uint8_t(std::lround(UnroundedByte(value))); }
    float Value(std::uint8_t byte) const { return float(byte) / 255 * Multiply() + Offset(); }

  private:
    float low_ = std::numeric_limits<float>::max(), high_ = std::numeric_limits<float>::lowest();
};

using ThreeRanges = std::array<Range, 3>;

/// Bytes of three coefficients; `values` of all luxels on surfaces, and on return what the bytes stand for.
void QuantizeThree(std::span<const std::size_t> mapped, std::vector<Vec3f> &values, std::size_t image, Lightmap &out) {
    ThreeRanges ranges;
    for (const Vec3f &value : values)
        for (std::size_t i = 0; i < 3; i++)
            ranges[i].Add(value[i]);
    for (std::size_t m = 0; m < mapped.size(); m++)
        for (std::size_t i = 0; i < 3; i++) {
            const std::uint8_t byte = ranges[i].Byte(values[m][i]);
            out.luxels[mapped[m]].coefficients[image][i] = byte;
            values[m][i] = ranges[i].Value(byte);
        }
    for (std::size_t i = 0; i < 3; i++) {
        out.range.multiply[image][i] = ranges[i].Multiply();
        out.range.add[image][i] = ranges[i].Offset();
    }
}

/// Square roots of color / luminance; 1 1 1 where that is too dark.
Vec3f RootChromaticity(const Vec3f &color, float luminance) {
    if (luminance < kColorlessLuminance)
        return {1, 1, 1};
    const Vec3f uvw = color / luminance;
    return {std::sqrt(uvw.x), std::sqrt(uvw.y), std::sqrt(uvw.z)};
}

/// Log luminance in the alpha of the color image; in high quality, its rounding error in that of the direction image.
void QuantizeLog(std::span<const std::size_t> mapped, std::span<const float> luminance, std::size_t image,
                 Lightmap &out) {
    const LogScale log = image == kHigh ? kHighLog : kLowLog;
    const auto logOf = [&](float l) { return std::clamp(Log2(l + log.black), -log.scale / 2, log.scale / 2); };
    Range range;
    for (const float l : luminance)
        range.Add(logOf(l));
    for (std::size_t m = 0; m < mapped.size(); m++) {
        auto &bytes = out.luxels[mapped[m]].coefficients;
        const float exact = range.UnroundedByte(logOf(luminance[m])), rounded = std::round(exact);
        bytes[image][3] = std::uint8_t(rounded);
        if (image == kHigh)
            bytes[image + 1][3] = UnitByte(exact - rounded + 0.5f);
    }
    out.range.multiply[image][3] = range.Multiply();
    out.range.add[image][3] = range.Offset();
}

/// Both images of one quality. Direction first, luminance last: it corrects rounding errors of the steps before.
void QuantizeImages(std::span<const LuxelLight> luxels, std::span<const std::size_t> mapped, std::size_t image,
                    const QuantizeOptions &options, Lightmap &out) {
    std::vector<Vec3f> directions, roots;
    for (const std::size_t i : mapped)
        directions.push_back(luxels[i].coefficients[image + 1]);
    QuantizeThree(mapped, directions, image + 1, out);
    out.range.add[image + 1][3] = kL1Flat;

    std::vector<float> luminance;
    for (std::size_t m = 0; m < mapped.size(); m++) {
        const LuxelLight &luxel = luxels[mapped[m]];
        const Vec3f color = NotNegative(luxel.coefficients[image]), n = SHOrder(luxel.normal);
        const float l = DirectionalLuminance(color);
        roots.push_back(RootChromaticity(color, l));
        const float exact = kL1Flat + Dot(luxel.coefficients[image + 1], n), stored = kL1Flat + Dot(directions[m], n);
        luminance.push_back(
            options.foldDirection && std::min(exact, stored) > kLeastDirectionality / 2 ? l * (exact / stored) : l);
    }
    QuantizeThree(mapped, roots, image, out);
    for (std::size_t m = 0; options.foldColor && m < mapped.size(); m++) {
        const float stored = DirectionalLuminance(roots[m] * roots[m]);
        luminance[m] /= stored > 0 ? stored : 1;
    }
    QuantizeLog(mapped, luminance, image, out);
}

std::array<std::uint8_t, 4> SkyBytes(const Vec3f &sky) {
    const float length = Length(sky);
    const Vec3f unit = length > 0 ? sky / length : Vec3f{};
    return {UnitByte(unit.x * 0.5f + 0.5f), UnitByte(unit.y * 0.5f + 0.5f), UnitByte(unit.z * 0.5f + 0.5f),
            UnitByte(std::sqrt(NotNegative(length)))};
}

} // namespace

void GatheredLight::AddL1(const L1Light &light, const Vec3f &lit, const Vec3f &normal) {
    incident += lit;
    l1 += light;
    l1Luminance += DirectionalLuminance(light.Evaluate(normal));
}

GatheredLight &GatheredLight::operator+=(const GatheredLight &o) {
    incident += o.incident;
    l1 += o.l1;
    l1Luminance += o.l1Luminance;
    skyOcclusion += o.skyOcclusion;
    unoccluded += o.unoccluded;
    return *this;
}

GatheredLight &GatheredLight::operator*=(float scale) {
    incident *= scale;
    l1 *= scale;
    l1Luminance *= scale;
    skyOcclusion *= scale;
    unoccluded *= scale;
    return *this;
}

LuxelLight ToCoefficients(const GatheredLuxel &gathered) {
    LuxelLight out;
    const ColorAndDirection high = Coefficients(gathered.high), low = Coefficients(gathered.low);
    out.coefficients = {high.color, high.direction, low.color, low.direction};
    out.skyOcclusion = gathered.high.skyOcclusion;
    out.unoccluded = gathered.high.unoccluded;
    out.normal = gathered.normal;
    out.mapped = gathered.mapped;
    return out;
}

Lightmap Quantize(int width, int height, std::span<const LuxelLight> luxels, const QuantizeOptions &options) {
    Lightmap out{width, height, false, {}, std::vector<LuxelBytes>(luxels.size())};
    std::vector<std::size_t> mapped;
    for (std::size_t i = 0; i < luxels.size(); i++)
        if (luxels[i].mapped)
            mapped.push_back(i);
    QuantizeImages(luxels, mapped, kHigh, options, out);
    QuantizeImages(luxels, mapped, kLow, options, out);
    for (const std::size_t i : mapped) {
        out.luxels[i].coverage = 255;
        out.luxels[i].skyOcclusion = SkyBytes(luxels[i].skyOcclusion);
        out.luxels[i].unoccluded = UnitByte(std::sqrt(NotNegative(luxels[i].unoccluded)));
        out.hasSkyOcclusion = out.hasSkyOcclusion || luxels[i].skyOcclusion != Vec3f{};
    }
    return out;
}

VisibilityMap Quantize(int width, int height, std::span<const Visibility> luxels) {
    VisibilityMap out{width, height, {}};
    for (const Visibility &luxel : luxels)
        out.luxels.push_back(luxel.mapped ? VisibilityBytes{UnitByte(luxel.visibility), 255} : VisibilityBytes{});
    return out;
}

} // namespace q3::lightmass
