// GPL-2.0-or-later. Images in memory, decoding of the formats that games ship, and reduction.
#pragma once

#include "common/error.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
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

/// Reads and decodes a file as DecodeImage does, but keeps all 16 bits of PNG. Errors: also those of ReadFile.
DeepImage ReadDeepImage(const std::filesystem::path &path);

/// Recognizes PNG, JPEG, WebP, DDS and KTX by their first bytes, and TGA by the extension of `name`. Errors: those of
/// the decoders, and a file of another format.
Image DecodeImage(std::span<const std::byte> file, std::string_view name);

/// Which row the texels given to EncodeTga begin with.
enum class TgaRows { TopFirst, BottomFirst };
/// An uncompressed TGA file whose first row is the lowest. Texels of 1 (gray), 3 (RGB) or 4 (RGBA) channels, width *
/// height of them; sides below 65536.
std::vector<std::byte> EncodeTga(std::span<const std::uint8_t> texels, int width, int height, int channels,
                                 TgaRows rows);

/// A PNG file with texels of 3 (RGB) or 4 (RGBA) channels, row 0 on top, width * height of them. `name` is for
/// messages. Errors: another number of channels or of texels, and a size that CheckImageSize refuses.
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

/// Error unless 1..16384 texels a side and at most 2^26 in all: 256 MiB as RGBA.
inline void CheckImageSize(std::uint64_t width, std::uint64_t height, std::string_view name) {
    constexpr std::uint64_t kMaxSide = 16384, kMaxTexels = std::uint64_t(1) << 26;
    if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide || width * height > kMaxTexels)
        throw Error("{}: an image of {} x {}, expected 1 to {} a side and at most {} texels", name, width, height,
                    kMaxSide, kMaxTexels);
}

/// Palette indexes, row 0 on top, one byte a texel. The palette itself is not kept.
struct IndexImage {
    int width = 0, height = 0;
    std::vector<std::uint8_t> indexes;
};

/// PCX of 8 bits a texel and one plane. `name`, errors and limits as for DecodeTga.
IndexImage DecodePcx(std::span<const std::byte> file, std::string_view name);
/// The same for PNG; std::nullopt if it is valid but has no palette.
std::optional<IndexImage> DecodePngIndexes(std::span<const std::byte> file, std::string_view name);

/// The image with its longer side at most `longestSide` texels (over 0), the other in proportion; the same image if it
/// fits already. Each texel is the mean of the area that it covers, of stored values, as engines make mipmaps.
Image Reduced(const Image &image, int longestSide);

/// WebP, lossy or lossless, through libwebp. Error for animations.
Image DecodeWebp(std::span<const std::byte> file, std::string_view name);

// Textures for graphics cards: the largest mipmap; of a cube map, an array or a volume, the first image.

/// DDS, also with the extended header of DirectX 10: BC1 to BC5, BC7, and uncompressed texels with any masks.
Image DecodeDds(std::span<const std::byte> file, std::string_view name);
/// KTX 1, and KTX 2 without supercompression: BC1 to BC5, BC7, ETC1, ETC2 and uncompressed texels of up to 8 bits a
/// channel. The first row is the top row, as in engines, which do not look at KTXorientation.
Image DecodeKtx(std::span<const std::byte> file, std::string_view name);
/// Crunch (.crn): checks the header only. One texel of middle gray, 128, stands for the colors.
Image DecodeCrn(std::span<const std::byte> file, std::string_view name);

/// Width and height from the header; nullopt: another format, damaged, or over 16384 texels a side.
std::optional<std::array<int, 2>> WebpSize(std::span<const std::byte> file);
std::optional<std::array<int, 2>> KtxSize(std::span<const std::byte> file);
std::optional<std::array<int, 2>> CrnSize(std::span<const std::byte> file);

} // namespace q3
