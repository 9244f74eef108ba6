// GPL-2.0-or-later. Images of floats in memory, and the formats that hold them.
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

} // namespace q3
