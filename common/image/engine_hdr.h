// GPL-2.0-or-later. HDR light as engines load it from files beside a map.
#pragma once

#include "common/image/float_image.h"

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

// Light is on the unit scale, where 1 is byte 255, and row 0 is that of the lightmap page. Negative values and NaN
// become 0 in all of these files.

/// Side of the pages that ioquake3 and Quake3e load.
inline constexpr int kIoquake3PageSide = 128;

/// maps/NAME/lm_NNNN.hdr of ioquake3 and Quake3e: three newlines, then 128 * 128 * 3 little-endian floats on the byte
/// scale (255 is full light), row 0 first, without the last three bytes. The file has 196608 bytes, because those
/// engines expect the size of the floats alone but skip a header up to an empty line and the line after it. They read
/// three bytes past the end, so blue of the last luxel, (127, 127), is undefined: leave this luxel unused. Errors: a
/// page of another size.
std::vector<std::byte> EncodeIoquake3Hdr(const FloatImage &page);
/// The undefined channel reads as 0. Errors: another length, no newlines at the start.
FloatImage DecodeIoquake3Hdr(std::span<const std::byte> file, std::string_view name);

/// maps/NAME/lm_NNNN.hdr of OpenJK's rend2: Radiance on the unit scale, the last row of the page on top. The engine
/// divides by pi.
std::vector<std::byte> EncodeRend2Hdr(const FloatImage &page);
/// Errors: those of DecodeHdr.
FloatImage DecodeRend2Hdr(std::span<const std::byte> file, std::string_view name);

/// Name of the file of vertex light.
inline constexpr std::string_view kVertexLightFile = "vertlight.raw";
/// The value of full light in it.
inline constexpr float kIoquake3VertexScale = 255, kRend2VertexScale = 1;
/// maps/NAME/vertlight.raw: three little-endian floats for each draw vertex, light times `fullLight`.
std::vector<std::byte> EncodeVertexLight(std::span<const Vec3f> light, float fullLight);
/// Errors: a length that is not 12 bytes for each of `vertices`, which engines refuse too.
std::vector<Vec3f> DecodeVertexLight(std::span<const std::byte> file, std::size_t vertices, float fullLight,
                                     std::string_view name);

} // namespace q3
