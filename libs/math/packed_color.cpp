// GPL-2.0-or-later. HDR colors in four bytes: three mantissas with one exponent.
#include "libs/math/packed_color.h"

#include <algorithm>

namespace q3 {

namespace {

constexpr double kExp32Full = 255;           ///< full light in ColorRGBExp32
constexpr int kE5Bias = 24, kRgbeBias = 136; ///< a channel is mantissa * 2^(code of the exponent - bias)
constexpr std::uint32_t kE5Mask = 511;       ///< of a mantissa of 9 bits

struct SharedExponent {
    std::array<std::uint32_t, 3> mantissas{};
    int exponent = 0; ///< channel = mantissa * 2^exponent
};

std::uint32_t Rounded(double value) {
    return std::uint32_t(std::floor(value + 0.5));
}

/// color * scale, channels limited to `most`, with mantissas of `bits` bits and an exponent of at least `least`.
/// Scaling by powers of two is exact in double.
SharedExponent ToSharedExponent(const Vec3f &color, double scale, double most, int bits, int least) {
    std::array<double, 3> channels{};
    for (std::size_t i = 0; i < 3; ++i)
        channels[i] = color[i] > 0 ? std::min(double(color[i]) * scale, most) : 0; // NaN is not above 0
    const double largest = *std::ranges::max_element(channels);
    SharedExponent shared;
    if (largest == 0)
        return shared;
    int exponent = 0;
    std::frexp(largest, &exponent);
    shared.exponent = std::max(exponent - bits, least);
    if (Rounded(std::ldexp(largest, -shared.exponent)) >> bits != 0)
        ++shared.exponent; // rounding up overflowed the mantissa
    for (std::size_t i = 0; i < 3; ++i)
        shared.mantissas[i] = Rounded(std::ldexp(channels[i], -shared.exponent));
    return shared;
}

bool IsBlack(const SharedExponent &shared) {
    return shared.mantissas == std::array<std::uint32_t, 3>{};
}

} // namespace

std::uint32_t EncodeE5bgr9(const Vec3f &color) {
    const SharedExponent shared = ToSharedExponent(color, 1, double(kMaxE5bgr9), 9, -kE5Bias);
    if (IsBlack(shared))
        return 0;
    return shared.mantissas[0] | shared.mantissas[1] << 9 | shared.mantissas[2] << 18 |
           std::uint32_t(shared.exponent + kE5Bias) << 27;
}

Vec3f DecodeE5bgr9(std::uint32_t code) {
    const float unit = std::ldexp(1.0f, int(code >> 27) - kE5Bias);
    return Vec3f(float(code & kE5Mask), float(code >> 9 & kE5Mask), float(code >> 18 & kE5Mask)) * unit;
}

std::vector<std::uint32_t> EncodeE5bgr9(std::span<const Vec3f> colors) {
    std::vector<std::uint32_t> codes;
    codes.reserve(colors.size());
    for (const Vec3f &color : colors)
        codes.push_back(EncodeE5bgr9(color));
    return codes;
}

std::vector<Vec3f> DecodeE5bgr9(std::span<const std::uint32_t> codes) {
    std::vector<Vec3f> colors;
    colors.reserve(codes.size());
    for (const std::uint32_t code : codes)
        colors.push_back(DecodeE5bgr9(code));
    return colors;
}

Rgbe EncodeRgbe(const Vec3f &color) {
    // Codes of the exponent are 1 to 255, as 0 is black.
    const SharedExponent shared = ToSharedExponent(color, 1, std::ldexp(255.0, 255 - kRgbeBias), 8, 1 - kRgbeBias);
    if (IsBlack(shared))
        return {};
    return {std::uint8_t(shared.mantissas[0]), std::uint8_t(shared.mantissas[1]), std::uint8_t(shared.mantissas[2]),
            std::uint8_t(shared.exponent + kRgbeBias)};
}

Vec3f DecodeRgbe(const Rgbe &code) {
    if (code[3] == 0)
        return {};
    const auto channel = [&](std::size_t i) { return std::ldexp(float(code[i]), int(code[3]) - kRgbeBias); };
    return {channel(0), channel(1), channel(2)};
}

ColorRgbExp32 EncodeRgbExp32(const Vec3f &color) {
    const SharedExponent shared = ToSharedExponent(color, kExp32Full, std::ldexp(kExp32Full, INT8_MAX), 8, INT8_MIN);
    if (IsBlack(shared))
        return {};
    return {std::uint8_t(shared.mantissas[0]), std::uint8_t(shared.mantissas[1]), std::uint8_t(shared.mantissas[2]),
            std::int8_t(shared.exponent)};
}

Vec3f DecodeRgbExp32(const ColorRgbExp32 &code) {
    const auto channel = [&](std::uint8_t byte) {
        return float(std::ldexp(double(byte), int(code.exponent)) / kExp32Full);
    };
    return {channel(code.r), channel(code.g), channel(code.b)};
}

} // namespace q3
