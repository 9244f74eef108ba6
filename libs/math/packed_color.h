// GPL-2.0-or-later. HDR colors in four bytes: three mantissas with one exponent.
#pragma once

#include "libs/math/vec.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace q3 {

// Encoders round to nearest and use the least exponent whose mantissas hold the rounded channels, so that the mantissa
// of the largest channel has its top bit set. Negative channels and NaN give 0; channels above the maximum, infinity
// included, give the maximum. With b bits of mantissa the relative error of the largest channel is at most 2^-b; the
// error of the others is at most 2^-b times the largest channel that is stored. Encoding a decoded color is exact.

/// GL's RGB9_E5 and the E5BGR9 of BSPX lumps: bits 0-8 red, 9-17 green, 18-26 blue, 27-31 exponent; a channel is
/// mantissa * 2^(exponent - 24). Below 2^-16 the absolute error is at most 2^-25.
std::uint32_t EncodeE5bgr9(const Vec3f &color);
Vec3f DecodeE5bgr9(std::uint32_t code);
/// The same for all elements, in order.
std::vector<std::uint32_t> EncodeE5bgr9(std::span<const Vec3f> colors);
std::vector<Vec3f> DecodeE5bgr9(std::span<const std::uint32_t> codes);
inline constexpr float kMaxE5bgr9 = 65408; ///< 511 * 2^7

/// Radiance: mantissas of red, green, blue, then the exponent E; a channel is mantissa * 2^(E - 136). E = 0 is black.
/// The maximum is 255 * 2^119, about 1.7e38; below 2^-128 the absolute error is at most 2^-136.
using Rgbe = std::array<std::uint8_t, 4>;
Rgbe EncodeRgbe(const Vec3f &color);
Vec3f DecodeRgbe(const Rgbe &code);

/// ColorRGBExp32 of Source: a channel is byte * 2^exponent on a scale where 255 is full light. Colors here are on the
/// unit scale, where 1 is full light: byte * 2^exponent / 255. The maximum is 2^127.
struct ColorRgbExp32 {
    std::uint8_t r = 0, g = 0, b = 0;
    std::int8_t exponent = 0;
    bool operator==(const ColorRgbExp32 &) const = default;
};
ColorRgbExp32 EncodeRgbExp32(const Vec3f &color);
Vec3f DecodeRgbExp32(const ColorRgbExp32 &code);

} // namespace q3
