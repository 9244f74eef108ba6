// GPL-2.0-or-later. Images in memory, and decoding of the formats that games ship.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// 8-bit RGBA, row 0 on top, 4 * width * height bytes. Never zero-sized once decoded.
struct Image {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgba;

    std::array<std::uint8_t, 4> Texel(int column, int row) const {
        const std::size_t at = 4 * (std::size_t(row) * std::size_t(width) + std::size_t(column));
        return {rgba[at], rgba[at + 1], rgba[at + 2], rgba[at + 3]};
    }
};

/// 16-bit RGBA, 65535 for full, row 0 on top. For images whose values are quantities, such as heights.
struct DeepImage {
    int width = 0, height = 0;
    int bits = 8; ///< of a channel in the file: its values are multiples of 65535 / (2^bits - 1)
    std::vector<std::uint16_t> rgba;
};

/// Decoders. `name` is for messages. Errors: Error for anything damaged, unsupported or over 16384 texels a side;
/// memory use stays in proportion to the input (header sizes are checked against the data first).
Image DecodeTga(std::span<const std::byte> file, std::string_view name);
Image DecodePng(std::span<const std::byte> file, std::string_view name);
Image DecodeJpeg(std::span<const std::byte> file, std::string_view name);
/// All 16 bits of a channel, where DecodePng keeps 8.
DeepImage DecodeDeepPng(std::span<const std::byte> file, std::string_view name);

/// Reads an image file: PNG and JPEG by their first bytes, TGA by its extension. Errors: those of ReadFile and of the
/// decoders, and a file that is none of these.
DeepImage ReadDeepImage(const std::filesystem::path &path);

/// By its first bytes, else by the extension of `name`: PNG, JPEG, TGA. Errors: those of the decoders, and another
/// format.
Image DecodeImage(std::span<const std::byte> file, std::string_view name);

/// Which row the texels given to EncodeTga begin with.
enum class TgaRows { TopFirst, BottomFirst };
/// An uncompressed TGA file whose first row is the lowest. Texels of 1 (gray), 3 (RGB) or 4 (RGBA) channels, width *
/// height of them; sides below 65536.
std::vector<std::byte> EncodeTga(std::span<const std::uint8_t> texels, int width, int height, int channels,
                                 TgaRows rows);

/// A PNG file with texels of 3 (RGB) or 4 (RGBA) channels, row 0 on top, width * height of them. `name` is for
/// messages.
std::vector<std::byte> EncodePng(std::span<const std::uint8_t> texels, int width, int height, int channels,
                                 std::string_view name);
/// A JPEG file of the colors, without alpha; chroma at half the resolution. `quality`: 1 to 100. `name` is for
/// messages.
std::vector<std::byte> EncodeJpeg(const Image &image, int quality, std::string_view name);

/// Writes an RGBA image as PNG, atomically.
void WritePng(const std::filesystem::path &path, const Image &image);
/// The same with texels as for EncodePng.
void WritePng(const std::filesystem::path &path, std::span<const std::uint8_t> texels, int width, int height,
              int channels);

} // namespace q3
