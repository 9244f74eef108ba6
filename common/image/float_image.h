// GPL-2.0-or-later. Images of floats in memory, the formats that hold them, and the HDR light that engines load from
// files beside a map.
#pragma once

#include "libs/math/vec.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Linear RGB, row 0 on top. Never zero-sized once decoded. Channels may be negative, infinite or NaN where a format
/// can hold that (PFM, OpenEXR).
struct FloatImage {
    int width = 0, height = 0;
    std::vector<Vec3f> texels; ///< width * height

    const Vec3f &Texel(int column, int row) const {
        return texels[std::size_t(row) * std::size_t(width) + std::size_t(column)];
    }
};

/// The image with its rows in reverse order.
FloatImage FlippedRows(const FloatImage &image);

// Decoders. `name` is for messages. Errors: Error for anything damaged or unsupported, and sizes as in image.h.

/// Radiance: RGBE, flat or run-length encoded in the old or the new way, rows top first (-Y) or bottom first (+Y),
/// columns from left to right. Values are divided by the product of the EXPOSURE lines of the header.
FloatImage DecodeHdr(std::span<const std::byte> file, std::string_view name);
/// Portable float map of three channels (PF) or of one, which gives gray (Pf). Of the scale in its third line only
/// the sign counts, which gives the byte order.
FloatImage DecodePfm(std::span<const std::byte> file, std::string_view name);
/// OpenEXR: channels R, G and B of any type, in one part of scan lines or tiles; the offset of the data window is
/// dropped. Error without HasOpenExr.
FloatImage DecodeExr(std::span<const std::byte> file, std::string_view name);

/// Radiance, run-length encoded, rows top first. Precision and range are those of EncodeRgbe.
std::vector<std::byte> EncodeHdr(const FloatImage &image);
/// Little endian, three channels. Exact.
std::vector<std::byte> EncodePfm(const FloatImage &image);
/// 32-bit float channels, ZIP compression. Exact; half floats would have 11 bits of mantissa and end at 65504. Error
/// without HasOpenExr.
std::vector<std::byte> EncodeExr(const FloatImage &image);

/// Whether the program was built with OpenEXR.
bool HasOpenExr();

/// A format of float images.
struct FloatImageFormat {
    std::string_view extension; ///< without its dot
    FloatImage (*decode)(std::span<const std::byte> file, std::string_view name);
    std::vector<std::byte> (*encode)(const FloatImage &image);
};
/// hdr, exr, pfm.
std::span<const FloatImageFormat> FloatImageFormats();
/// By extension, ignoring case; null: unknown.
const FloatImageFormat *FindFloatImageFormat(std::string_view extension);
/// Their extensions for messages: "hdr, exr or pfm".
std::string FloatImageExtensions();

/// In the format of the path's extension. Errors: those of the coders and the file, and an unknown extension.
FloatImage ReadFloatImage(const std::filesystem::path &path);
void WriteFloatImage(const std::filesystem::path &path, const FloatImage &image);

// ---- HDR light as engines load it from files beside a map ----

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
