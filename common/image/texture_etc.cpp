// GPL-2.0-or-later. Blocks of ETC1, ETC2 and EAC alpha, as in chapters 21 and 22 of the Khronos Data Format
// Specification 1.3.
#include "common/image/texture_data.h"

#include <algorithm>

namespace q3 {

namespace {

using Color = std::array<int, 3>; ///< 0 to 255

/// What is added to the base color for indexes 0 and 1 of a texel; subtracted for 2 and 3.
constexpr std::array<std::array<int, 2>, 8> kModifiers = {
    {{2, 8}, {5, 17}, {9, 29}, {13, 42}, {18, 60}, {24, 80}, {33, 106}, {47, 183}}};
constexpr std::array<int, 8> kDistances = {3, 6, 11, 16, 23, 32, 41, 64}; ///< of modes T and H
constexpr std::array<std::array<int, 8>, 16> kAlphaModifiers = {{{-3, -6, -9, -15, 2, 5, 8, 14},
                                                                 {-3, -7, -10, -13, 2, 6, 9, 12},
                                                                 {-2, -5, -8, -13, 1, 4, 7, 12},
                                                                 {-2, -4, -6, -13, 1, 3, 5, 12},
                                                                 {-3, -6, -8, -12, 2, 5, 7, 11},
                                                                 {-3, -7, -9, -11, 2, 6, 8, 10},
                                                                 {-4, -7, -8, -11, 3, 6, 7, 10},
                                                                 {-3, -5, -8, -11, 2, 4, 7, 10},
                                                                 {-2, -6, -8, -10, 1, 5, 7, 9},
                                                                 {-2, -5, -8, -10, 1, 4, 7, 9},
                                                                 {-2, -4, -8, -10, 1, 3, 7, 9},
                                                                 {-2, -5, -7, -10, 1, 4, 6, 9},
                                                                 {-3, -4, -7, -10, 2, 3, 6, 9},
                                                                 {-1, -2, -3, -10, 0, 1, 2, 9},
                                                                 {-4, -6, -8, -9, 3, 5, 7, 8},
                                                                 {-3, -5, -7, -9, 2, 4, 6, 8}}};

std::uint8_t Clamped(int value) {
    return std::uint8_t(std::clamp(value, 0, 255));
}

Color Moved(const Color &color, int by) {
    return {color[0] + by, color[1] + by, color[2] + by};
}

/// A value of `bits` bits with its high bits repeated below them.
int Extended(unsigned value, unsigned bits) {
    return int(value << (8 - bits) | value >> (2 * bits - 8));
}

class EtcColors {
  public:
    EtcColors(std::span<const std::byte> block, bool punchThrough) {
        for (const std::byte byte : block.first(8))
            word_ = word_ << 8 | std::to_integer<std::uint64_t>(byte);
        isOpaque_ = !punchThrough || Bits(33, 1) != 0;
        isDifferential_ = punchThrough || Bits(33, 1) != 0;
    }

    BlockTexels Decode() {
        if (!isDifferential_)
            DecodeHalves({Wide(60), Wide(52), Wide(44)}, {Wide(56), Wide(48), Wide(40)});
        else if (const std::array<int, 3> second = {Second(56), Second(48), Second(40)}; !IsIn5Bits(second[0]))
            DecodeT();
        else if (!IsIn5Bits(second[1]))
            DecodeH();
        else if (!IsIn5Bits(second[2]))
            DecodePlanar();
        else
            DecodeHalves(
                {Extended(Bits(59, 5), 5), Extended(Bits(51, 5), 5), Extended(Bits(43, 5), 5)},
                {Extended(unsigned(second[0]), 5), Extended(unsigned(second[1]), 5), Extended(unsigned(second[2]), 5)});
        return texels_;
    }

  private:
    unsigned Bits(unsigned lowest, unsigned count) const { return unsigned(word_ >> lowest) & ((1u << count) - 1); }
    /// Four bits as a color.
    int Wide(unsigned lowest) const { return Extended(Bits(lowest, 4), 4); }
    /// The second color of differential mode: five bits, plus three with a sign below them.
    int Second(unsigned lowest) const {
        const int difference = int(Bits(lowest, 3));
        return int(Bits(lowest + 3, 5)) + (difference >= 4 ? difference - 8 : difference);
    }
    static bool IsIn5Bits(int value) { return value >= 0 && value < 32; }

    /// Index of a texel: texels are numbered by columns.
    unsigned IndexAt(unsigned x, unsigned y) const {
        const unsigned number = 4 * x + y;
        return Bits(16 + number, 1) << 1 | Bits(number, 1);
    }
    void Put(unsigned x, unsigned y, const Color &color) {
        const std::size_t at = 4 * std::size_t(4 * y + x);
        for (std::size_t channel = 0; channel < 3; ++channel)
            texels_[at + channel] = Clamped(color[channel]);
        texels_[at + 3] = 255;
    }

    /// Two halves with a base color each, side by side or one above the other.
    void DecodeHalves(const Color &first, const Color &second) {
        const bool above = Bits(32, 1) != 0;
        const std::array<unsigned, 2> tables = {Bits(37, 3), Bits(34, 3)};
        for (unsigned y = 0; y < 4; ++y)
            for (unsigned x = 0; x < 4; ++x) {
                const bool isSecond = (above ? y : x) >= 2;
                const unsigned index = IndexAt(x, y);
                if (!isOpaque_ && index == 2) // transparent black
                    continue;
                int modifier = kModifiers[tables[isSecond]][index & 1];
                if (!isOpaque_ && index == 0)
                    modifier = 0;
                Put(x, y, Moved(isSecond ? second : first, index >= 2 ? -modifier : modifier));
            }
    }

    void PutPalette(const std::array<Color, 4> &palette) {
        for (unsigned y = 0; y < 4; ++y)
            for (unsigned x = 0; x < 4; ++x)
                if (const unsigned index = IndexAt(x, y); isOpaque_ || index != 2)
                    Put(x, y, palette[index]);
    }

    void DecodeT() {
        const Color first = {Extended(Bits(59, 2) << 2 | Bits(56, 2), 4), Wide(52), Wide(48)};
        const Color second = {Wide(44), Wide(40), Wide(36)};
        const int distance = kDistances[Bits(34, 2) << 1 | Bits(32, 1)];
        PutPalette({first, Moved(second, distance), second, Moved(second, -distance)});
    }

    void DecodeH() {
        const unsigned red1 = Bits(59, 4), green1 = Bits(56, 3) << 1 | Bits(52, 1),
                       blue1 = Bits(51, 1) << 3 | Bits(47, 3), red2 = Bits(43, 4), green2 = Bits(39, 4),
                       blue2 = Bits(35, 4);
        const bool isOrdered = (red1 << 8 | green1 << 4 | blue1) >= (red2 << 8 | green2 << 4 | blue2);
        const int distance = kDistances[Bits(34, 1) << 2 | Bits(32, 1) << 1 | (isOrdered ? 1 : 0)];
        const Color first = {Extended(red1, 4), Extended(green1, 4), Extended(blue1, 4)};
        const Color second = {Extended(red2, 4), Extended(green2, 4), Extended(blue2, 4)};
        PutPalette(
            {Moved(first, distance), Moved(first, -distance), Moved(second, distance), Moved(second, -distance)});
    }

    /// Colors of three corners, and a plane through them. Always opaque.
    void DecodePlanar() {
        const Color origin = {Extended(Bits(57, 6), 6), Extended(Bits(56, 1) << 6 | Bits(49, 6), 7),
                              Extended(Bits(48, 1) << 5 | Bits(43, 2) << 3 | Bits(39, 3), 6)};
        const Color right = {Extended(Bits(34, 5) << 1 | Bits(32, 1), 6), Extended(Bits(25, 7), 7),
                             Extended(Bits(19, 6), 6)};
        const Color below = {Extended(Bits(13, 6), 6), Extended(Bits(6, 7), 7), Extended(Bits(0, 6), 6)};
        for (unsigned y = 0; y < 4; ++y)
            for (unsigned x = 0; x < 4; ++x) {
                Color color;
                for (std::size_t i = 0; i < 3; ++i)
                    color[i] =
                        (int(x) * (right[i] - origin[i]) + int(y) * (below[i] - origin[i]) + 4 * origin[i] + 2) >> 2;
                Put(x, y, color);
            }
    }

    std::uint64_t word_ = 0; ///< the block, its first byte highest
    bool isOpaque_ = true, isDifferential_ = false;
    BlockTexels texels_{};
};

/// Sets alpha from a block of EAC: a base, a factor, a table, and three bits for each texel, by columns.
void AddEacAlpha(std::span<const std::byte> block, BlockTexels &texels) {
    std::uint64_t word = 0;
    for (const std::byte byte : block.first(8))
        word = word << 8 | std::to_integer<std::uint64_t>(byte);
    const int base = int(word >> 56), factor = int(word >> 52 & 15);
    const auto &table = kAlphaModifiers[word >> 48 & 15];
    for (unsigned number = 0; number < 16; ++number) {
        const unsigned index = unsigned(word >> (45 - 3 * number)) & 7, x = number / 4, y = number % 4;
        texels[4 * std::size_t(4 * y + x) + 3] = Clamped(base + factor * table[index]);
    }
}

} // namespace

BlockTexels DecodeEtcBlock(TextureBlocks format, std::span<const std::byte> block) {
    if (format != TextureBlocks::Etc2Alpha)
        return EtcColors(block, format == TextureBlocks::Etc2PunchThrough).Decode();
    BlockTexels texels = EtcColors(block.subspan(8), false).Decode();
    AddEacAlpha(block, texels);
    return texels;
}

} // namespace q3
