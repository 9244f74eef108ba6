// GPL-2.0-or-later. Texels as textures for graphics cards hold them: compressed blocks, and colors packed into bits.
#include "common/image/texture_data.h"

#include <squish.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace q3 {

// ---- Compressed blocks ----

namespace {

constexpr std::size_t kBlockSide = 4; ///< texels

std::size_t BytesOfBlock(TextureBlocks format) {
    switch (format) {
    case TextureBlocks::Bc1:
    case TextureBlocks::Bc1Opaque:
    case TextureBlocks::Bc4:
    case TextureBlocks::Etc2:
    case TextureBlocks::Etc2PunchThrough:
        return 8;
    default:
        return 16;
    }
}

std::size_t BlocksAlong(int side) {
    return (std::size_t(side) + kBlockSide - 1) / kBlockSide;
}

BlockTexels SquishBlock(std::span<const std::byte> block, int format) {
    BlockTexels texels{};
    squish::Decompress(texels.data(), block.data(), format);
    return texels;
}

/// The channel of a block of BC4, which is coded as the alpha of BC3.
std::array<std::uint8_t, 16> Bc4Channel(std::span<const std::byte> block) {
    std::array<std::byte, 16> asBc3{};
    std::ranges::copy(block.first(8), asBc3.begin());
    const BlockTexels texels = SquishBlock(asBc3, squish::kDxt5);
    std::array<std::uint8_t, 16> channel{};
    for (std::size_t i = 0; i < channel.size(); ++i)
        channel[i] = texels[4 * i + 3];
    return channel;
}

BlockTexels Bc4Block(std::span<const std::byte> block) {
    BlockTexels texels{};
    const auto gray = Bc4Channel(block);
    for (std::size_t i = 0; i < gray.size(); ++i) {
        std::fill_n(texels.begin() + std::ptrdiff_t(4 * i), 3, gray[i]);
        texels[4 * i + 3] = 255;
    }
    return texels;
}

/// z of the unit normal with these x and y, all as bytes: 0 is -1, 255 is 1.
std::uint8_t NormalZ(std::uint8_t x, std::uint8_t y) {
    const double nx = x / 127.5 - 1, ny = y / 127.5 - 1;
    return std::uint8_t(std::lround(127.5 + 127.5 * std::sqrt(std::max(0.0, 1 - nx * nx - ny * ny))));
}

BlockTexels Bc5Block(std::span<const std::byte> block) {
    BlockTexels texels{};
    const auto x = Bc4Channel(block), y = Bc4Channel(block.subspan(8));
    for (std::size_t i = 0; i < x.size(); ++i) {
        const std::array<std::uint8_t, 4> texel = {x[i], y[i], NormalZ(x[i], y[i]), 255};
        std::ranges::copy(texel, texels.begin() + std::ptrdiff_t(4 * i));
    }
    return texels;
}

BlockTexels DecodeBlock(TextureBlocks format, std::span<const std::byte> block) {
    switch (format) {
    case TextureBlocks::Bc1:
        return SquishBlock(block, squish::kDxt1);
    case TextureBlocks::Bc1Opaque: {
        BlockTexels texels = SquishBlock(block, squish::kDxt1);
        for (std::size_t i = 3; i < texels.size(); i += 4)
            texels[i] = 255;
        return texels;
    }
    case TextureBlocks::Bc2:
        return SquishBlock(block, squish::kDxt3);
    case TextureBlocks::Bc3:
        return SquishBlock(block, squish::kDxt5);
    case TextureBlocks::Bc4:
        return Bc4Block(block);
    case TextureBlocks::Bc5:
        return Bc5Block(block);
    case TextureBlocks::Bc7:
        return DecodeBc7Block(block.first<16>());
    default:
        return DecodeEtcBlock(format, block);
    }
}

} // namespace

std::size_t BytesOfBlocks(TextureBlocks format, int width, int height) {
    return BlocksAlong(width) * BlocksAlong(height) * BytesOfBlock(format);
}

std::vector<std::uint8_t> DecodeBlocks(TextureBlocks format, std::span<const std::byte> blocks, int width, int height) {
    const std::size_t across = BlocksAlong(width), down = BlocksAlong(height), bytes = BytesOfBlock(format);
    std::vector<std::uint8_t> rgba(4 * std::size_t(width) * std::size_t(height));
    for (std::size_t block = 0; block < across * down; ++block) {
        const BlockTexels texels = DecodeBlock(format, blocks.subspan(block * bytes, bytes));
        const std::size_t left = block % across * kBlockSide, top = block / across * kBlockSide;
        const std::size_t columns = std::min(kBlockSide, std::size_t(width) - left),
                          rows = std::min(kBlockSide, std::size_t(height) - top);
        for (std::size_t row = 0; row < rows; ++row)
            std::copy_n(texels.begin() + std::ptrdiff_t(4 * kBlockSide * row), 4 * columns,
                        rgba.begin() + std::ptrdiff_t(4 * ((top + row) * std::size_t(width) + left)));
    }
    return rgba;
}

// ---- Colors packed into bits ----

namespace {

/// The bits of the mask, scaled to 0 to 255; 255 without a mask.
std::uint8_t ChannelOf(unsigned texel, unsigned mask) {
    if (mask == 0)
        return 255;
    const int shift = std::countr_zero(mask);
    const std::uint64_t most = mask >> shift, value = (texel & mask) >> shift;
    return std::uint8_t((2 * 255 * value + most) / (2 * most));
}

} // namespace

bool IsReadable(const TexelMasks &layout) {
    if (layout.bits % 8 != 0 || layout.bits < 8 || layout.bits > 32)
        return false;
    const unsigned all = layout.bits == 32 ? ~0u : (1u << layout.bits) - 1;
    return std::ranges::all_of(layout.masks, [all](unsigned mask) {
        const unsigned low = mask == 0 ? 0 : mask >> std::countr_zero(mask);
        return (mask & ~all) == 0 && (low & (low + 1)) == 0; // one run of bits
    });
}

std::vector<std::uint8_t> DecodeMasked(const TexelMasks &layout, std::span<const std::byte> texels, int width,
                                       int height, std::size_t rowBytes, TexelByteOrder order) {
    const std::size_t bytes = layout.bits / 8;
    std::vector<std::uint8_t> rgba;
    rgba.reserve(4 * std::size_t(width) * std::size_t(height));
    for (std::size_t row = 0; row < std::size_t(height); ++row)
        for (std::size_t column = 0; column < std::size_t(width); ++column) {
            const auto stored = texels.subspan(row * rowBytes + column * bytes, bytes);
            unsigned texel = 0;
            for (std::size_t k = 0; k < bytes; ++k) {
                const std::size_t place = order == TexelByteOrder::Little ? k : bytes - 1 - k;
                texel |= std::to_integer<unsigned>(stored[k]) << (8 * place);
            }
            for (const unsigned mask : layout.masks)
                rgba.push_back(ChannelOf(texel, mask));
        }
    return rgba;
}

} // namespace q3
