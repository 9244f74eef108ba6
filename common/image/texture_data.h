// GPL-2.0-or-later. Texels as textures for graphics cards hold them: compressed blocks, and colors packed into bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// How a block of 4 x 4 texels is compressed. Sources: Khronos Data Format Specification 1.3, and for BC1 to BC3
/// libsquish. The sRGB formats hold the same bytes.
enum class TextureBlocks {
    Bc1,              ///< S3TC DXT1; transparent where a block says so
    Bc1Opaque,        ///< the same with black for transparent
    Bc2,              ///< DXT3, and DXT2
    Bc3,              ///< DXT5, and DXT4
    Bc4,              ///< RGTC1, ATI1: one channel, which gives gray
    Bc5,              ///< RGTC2, ATI2: x and y of a normal; blue is its z, which is not stored
    Bc7,              ///< BPTC
    Etc2,             ///< ETC2, and ETC1, which is a part of it
    Etc2PunchThrough, ///< ETC2 whose texels are opaque or transparent
    Etc2Alpha         ///< ETC2 with EAC alpha
};

/// Bytes of an image, whose blocks at the right and lower edge may reach beyond it.
std::size_t BytesOfBlocks(TextureBlocks format, int width, int height);

/// RGBA as in Image, of at least BytesOfBlocks bytes, in rows of blocks from the top.
std::vector<std::uint8_t> DecodeBlocks(TextureBlocks format, std::span<const std::byte> blocks, int width, int height);

/// Where the channels are in an uncompressed texel: bits of a texel, and masks of red, green, blue and alpha. A channel
/// without a mask is 255.
struct TexelMasks {
    unsigned bits = 0;
    std::array<unsigned, 4> masks{};
};

/// 8, 16, 24 or 32 bits, and a run of bits within them for each mask.
bool IsReadable(const TexelMasks &layout);

enum class TexelByteOrder { Little, Big };

/// RGBA as in Image, each channel scaled to 0 to 255 and rounded. `rowBytes`: from row to row; `texels` has at least
/// `height` times as many. The layout must be readable.
std::vector<std::uint8_t> DecodeMasked(const TexelMasks &layout, std::span<const std::byte> texels, int width,
                                       int height, std::size_t rowBytes, TexelByteOrder order);

// ---- Single blocks, for DecodeBlocks ----

/// RGBA of 4 x 4 texels, row 0 on top.
using BlockTexels = std::array<std::uint8_t, 64>;

/// 16 bytes of BC7. A block of the reserved mode is transparent black.
BlockTexels DecodeBc7Block(std::span<const std::byte, 16> block);
/// 8 bytes of ETC2, for Etc2Alpha after 8 of EAC.
BlockTexels DecodeEtcBlock(TextureBlocks format, std::span<const std::byte> block);

} // namespace q3
