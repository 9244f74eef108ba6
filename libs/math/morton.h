// GPL-2.0-or-later. Morton codes: points next to each other in this order are mostly near in space.
#pragma once

#include <cstdint>

namespace q3 {

/// Moves each bit i < 21 to bit 3 i, in steps: the masks leave groups of 16, 8, 4, 2 and 1 adjacent bits, ever farther
/// apart. Higher bits are dropped.
constexpr std::uint64_t SpreadBits(std::uint32_t x) {
    std::uint64_t bits = x;
    bits = (bits | bits << 32) & 0x1f00000000ffffull;
    bits = (bits | bits << 16) & 0x1f0000ff0000ffull;
    bits = (bits | bits << 8) & 0x100f00f00f00f00full;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3ull;
    return (bits | bits << 2) & 0x1249249249249249ull;
}

/// Interleaves the lowest 21 bits of the coordinates; in each group of three bits, x is the lowest.
constexpr std::uint64_t MortonCode(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return SpreadBits(x) | SpreadBits(y) << 1 | SpreadBits(z) << 2;
}

} // namespace q3
