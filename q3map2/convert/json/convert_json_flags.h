// GPL-2.0-or-later. Surface and content bits of a BSP shader as named flags. See docs/json.md.
#pragma once

#include "q3map2/shader/games.h"

#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace q3 {

enum class FlagKind { Surface, Content };

/// Bits that a surfaceparm sets in the flags of that kind.
std::uint32_t ParmBits(const SurfaceParm &parm, FlagKind kind);

/// Splits a value into named parts, ascending by bits. The game's table is searched from its end, so of two names for
/// the same bits the last one wins; a bit that no name covers is named "?".
std::vector<std::pair<std::string_view, std::uint32_t>> SplitFlags(std::uint32_t value, const Game &game,
                                                                   FlagKind kind);
/// A number as C's strtoul reads it: 0x.. hexadecimal, leading 0 octal, else decimal. False: not one, or over 32 bits.
bool ParseFlagNumber(std::string_view text, std::uint32_t &value);

} // namespace q3
