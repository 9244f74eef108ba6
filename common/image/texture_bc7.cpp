// GPL-2.0-or-later. Blocks of BC7, as in chapter 20 (BPTC) of the Khronos Data Format Specification 1.3.
#include "common/image/texture_data.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace q3 {

namespace {

constexpr std::size_t kTexels = 16, kMaxSubsets = 3, kChannels = 4, kAlpha = 3;

/// Bits of the fields of a block. A subset has two endpoints, on whose line the colors of its texels are.
struct Bc7Mode {
    unsigned subsets, partition, rotation, indexSelection, color, alpha;
    unsigned endpointLowBits, subsetLowBits; ///< 1: each endpoint, each subset has a lowest bit for all channels
    unsigned index, secondIndex;             ///< of a texel; the second is for alpha
};

constexpr std::array<Bc7Mode, 8> kBc7Modes = {{{3, 4, 0, 0, 4, 0, 1, 0, 3, 0},
                                               {2, 6, 0, 0, 6, 0, 0, 1, 3, 0},
                                               {3, 6, 0, 0, 5, 0, 0, 0, 2, 0},
                                               {2, 6, 0, 0, 7, 0, 1, 0, 2, 0},
                                               {1, 0, 2, 1, 5, 6, 0, 0, 2, 3},
                                               {1, 0, 2, 0, 7, 8, 0, 0, 2, 2},
                                               {1, 0, 0, 0, 7, 7, 1, 0, 4, 0},
                                               {2, 6, 0, 0, 5, 5, 1, 0, 2, 0}}};

/// Subset of each texel by partition: a bit for each, the first texel lowest.
constexpr std::array<std::uint16_t, 64> kTwoSubsets = {
    0xCCCC, 0x8888, 0xEEEE, 0xECC8, 0xC880, 0xFEEC, 0xFEC8, 0xEC80, 0xC800, 0xFFEC, 0xFE80, 0xE800, 0xFFE8,
    0xFF00, 0xFFF0, 0xF000, 0xF710, 0x008E, 0x7100, 0x08CE, 0x008C, 0x7310, 0x3100, 0x8CCE, 0x088C, 0x3110,
    0x6666, 0x366C, 0x17E8, 0x0FF0, 0x718E, 0x399C, 0xAAAA, 0xF0F0, 0x5A5A, 0x33CC, 0x3C3C, 0x55AA, 0x9696,
    0xA55A, 0x73CE, 0x13C8, 0x324C, 0x3BDC, 0x6996, 0xC33C, 0x9966, 0x0660, 0x0272, 0x04E4, 0x4E40, 0x2720,
    0xC936, 0x936C, 0x39C6, 0x639C, 0x9336, 0x9CC6, 0x817E, 0xE718, 0xCCF0, 0x0FCC, 0x7744, 0xEE22};
/// The same for three subsets: two bits for each texel.
constexpr std::array<std::uint32_t, 64> kThreeSubsets = {
    0xAA685050, 0x6A5A5040, 0x5A5A4200, 0x5450A0A8, 0xA5A50000, 0xA0A05050, 0x5555A0A0, 0x5A5A5050,
    0xAA550000, 0xAA555500, 0xAAAA5500, 0x90909090, 0x94949494, 0xA4A4A4A4, 0xA9A59450, 0x2A0A4250,
    0xA5945040, 0x0A425054, 0xA5A5A500, 0x55A0A0A0, 0xA8A85454, 0x6A6A4040, 0xA4A45000, 0x1A1A0500,
    0x0050A4A4, 0xAAA59090, 0x14696914, 0x69691400, 0xA08585A0, 0xAA821414, 0x50A4A450, 0x6A5A0200,
    0xA9A58000, 0x5090A0A8, 0xA8A09050, 0x24242424, 0x00AA5500, 0x24924924, 0x24499224, 0x50A50A50,
    0x500AA550, 0xAAAA4444, 0x66660000, 0xA5A0A5A0, 0x50A050A0, 0x69286928, 0x44AAAA44, 0x66666600,
    0xAA444444, 0x54A854A8, 0x95809580, 0x96969600, 0xA85454A8, 0x80959580, 0xAA141414, 0x96960000,
    0xAAAA1414, 0xA05050A0, 0xA0A5A5A0, 0x96000000, 0x40804080, 0xA9A8A9A8, 0xAAAAAA44, 0x2A4A5254};
/// Anchors by partition: the texel of the second of two subsets, and of the second and third of three, whose index
/// lacks its highest bit, which is 0. That of the first subset is texel 0.
constexpr std::array<std::uint8_t, 64> kAnchorOfTwo = {15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15,
                                                       15, 2,  8,  2,  2,  8,  8,  15, 2,  8,  2,  2,  8,  8,  2,  2,
                                                       15, 15, 6,  8,  2,  8,  15, 15, 2,  8,  2,  2,  2,  15, 15, 6,
                                                       6,  2,  6,  8,  15, 15, 2,  2,  15, 15, 15, 15, 15, 2,  2,  15};
constexpr std::array<std::uint8_t, 64> kSecondAnchorOfThree = {
    3, 3,  15, 15, 8, 3,  15, 15, 8,  8, 6,  6, 6,  5,  3,  3,  3, 3,  8, 15, 3, 3, 6, 10, 5, 8,  8, 6,  8,  5,  15, 15,
    8, 15, 3,  5,  6, 10, 8,  15, 15, 3, 15, 5, 15, 15, 15, 15, 3, 15, 5, 5,  5, 8, 5, 10, 5, 10, 8, 13, 15, 12, 3,  3};
constexpr std::array<std::uint8_t, 64> kThirdAnchorOfThree = {
    15, 8, 8, 3,  15, 15, 3,  8,  15, 15, 15, 15, 15, 15, 15, 8,  15, 8,  15, 3,  15, 8,
    15, 8, 3, 15, 6,  10, 15, 15, 10, 8,  15, 3,  15, 10, 10, 8,  9,  10, 6,  15, 8,  15,
    3,  6, 6, 8,  15, 3,  15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 3,  15, 15, 8};

/// Weight of the second endpoint in 64ths by index, for indexes of 2, 3 and 4 bits.
constexpr std::array<unsigned, 4> kWeights2 = {0, 21, 43, 64};
constexpr std::array<unsigned, 8> kWeights3 = {0, 9, 18, 27, 37, 46, 55, 64};
constexpr std::array<unsigned, 16> kWeights4 = {0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64};

unsigned WeightOf(unsigned index, unsigned bits) {
    return bits == 2 ? kWeights2[index] : bits == 3 ? kWeights3[index] : kWeights4[index];
}

/// Reads fields from the lowest bit of the first byte on.
class BlockBits {
  public:
    explicit BlockBits(std::span<const std::byte, 16> block) : block_(block) {}

    unsigned Take(unsigned count) {
        unsigned value = 0;
        for (unsigned i = 0; i < count; ++i, ++at_)
            value |= (std::to_integer<unsigned>(block_[at_ / 8]) >> (at_ % 8) & 1) << i;
        return value;
    }

  private:
    std::span<const std::byte, 16> block_;
    std::size_t at_ = 0;
};

using Endpoints = std::array<std::array<unsigned, kChannels>, 2 * kMaxSubsets>; ///< two by subset, RGBA
using Indexes = std::array<unsigned, kTexels>;

unsigned SubsetOf(const Bc7Mode &mode, unsigned partition, std::size_t texel) {
    return mode.subsets == 1   ? 0
           : mode.subsets == 2 ? kTwoSubsets[partition] >> texel & 1u
                               : kThreeSubsets[partition] >> (2 * texel) & 3u;
}

bool IsAnchor(const Bc7Mode &mode, unsigned partition, std::size_t texel) {
    return texel == 0 || (mode.subsets == 2 && texel == kAnchorOfTwo[partition]) ||
           (mode.subsets == 3 && (texel == kSecondAnchorOfThree[partition] || texel == kThirdAnchorOfThree[partition]));
}

/// The endpoints with 8 bits a channel.
Endpoints TakeEndpoints(const Bc7Mode &mode, BlockBits &bits) {
    Endpoints endpoints{};
    const std::size_t count = 2 * mode.subsets;
    for (std::size_t channel = 0; channel < kChannels; ++channel)
        for (std::size_t i = 0; i < count; ++i)
            endpoints[i][channel] = bits.Take(channel == kAlpha ? mode.alpha : mode.color);
    const bool hasLowBits = mode.endpointLowBits + mode.subsetLowBits > 0;
    unsigned lowBit = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (mode.endpointLowBits > 0 || (mode.subsetLowBits > 0 && i % 2 == 0))
            lowBit = bits.Take(1);
        for (std::size_t channel = 0; channel < kChannels; ++channel) {
            const unsigned stored = channel == kAlpha ? mode.alpha : mode.color;
            const unsigned size = stored + (hasLowBits ? 1 : 0);
            unsigned &value = endpoints[i][channel];
            value = hasLowBits ? value << 1 | lowBit : value;
            value = stored == 0 ? 255 : value << (8 - size) | value >> (2 * size - 8);
        }
    }
    return endpoints;
}

Indexes TakeIndexes(const Bc7Mode &mode, unsigned partition, unsigned size, BlockBits &bits) {
    Indexes indexes{};
    for (std::size_t texel = 0; texel < kTexels; ++texel)
        indexes[texel] = bits.Take(size - (IsAnchor(mode, partition, texel) ? 1 : 0));
    return indexes;
}

} // namespace

BlockTexels DecodeBc7Block(std::span<const std::byte, 16> block) {
    BlockTexels texels{};
    const auto modeNumber = std::size_t(std::countr_zero(std::to_integer<unsigned>(block[0]) | 0x100u));
    if (modeNumber >= kBc7Modes.size()) // reserved
        return texels;
    const Bc7Mode &mode = kBc7Modes[modeNumber];
    BlockBits bits(block);
    bits.Take(unsigned(modeNumber) + 1);
    const unsigned partition = bits.Take(mode.partition), rotation = bits.Take(mode.rotation);
    const bool alphaFirst = bits.Take(mode.indexSelection) != 0;
    const Endpoints endpoints = TakeEndpoints(mode, bits);
    Indexes colors = TakeIndexes(mode, partition, mode.index, bits), alphas = colors;
    unsigned colorBits = mode.index, alphaBits = mode.index;
    if (mode.secondIndex > 0) {
        alphas = TakeIndexes(mode, partition, mode.secondIndex, bits);
        alphaBits = mode.secondIndex;
    }
    if (alphaFirst) {
        std::swap(colors, alphas);
        std::swap(colorBits, alphaBits);
    }
    for (std::size_t texel = 0; texel < kTexels; ++texel) {
        const std::size_t first = 2 * SubsetOf(mode, partition, texel);
        const auto rgba = texels.begin() + std::ptrdiff_t(kChannels * texel);
        for (std::size_t channel = 0; channel < kChannels; ++channel) {
            const unsigned weight =
                channel == kAlpha ? WeightOf(alphas[texel], alphaBits) : WeightOf(colors[texel], colorBits);
            rgba[std::ptrdiff_t(channel)] = std::uint8_t(
                ((64 - weight) * endpoints[first][channel] + weight * endpoints[first + 1][channel] + 32) >> 6);
        }
        if (rotation > 0) // alpha changed places with red, green or blue
            std::swap(rgba[std::ptrdiff_t(kAlpha)], rgba[std::ptrdiff_t(rotation - 1)]);
    }
    return texels;
}

} // namespace q3
