// GPL-2.0-or-later. Surface and content flags by name: of one game for another, and in JSON.
#pragma once

#include "q3map2/bspfile/bspfile.h"
#include "q3map2/shader/games.h"

#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace q3 {

// ---- Surface and content bits of a BSP shader as named flags. See docs/reference/json.md ----

enum class FlagKind { Surface, Content };

/// Bits that a surfaceparm sets in the flags of that kind.
std::uint32_t ParmBits(const SurfaceParm &parm, FlagKind kind);

/// Splits a value into named parts, ascending by bits. The game's table is searched from its end, so of two names for
/// the same bits the last one wins; a bit that no name covers is named "?".
std::vector<std::pair<std::string_view, std::uint32_t>> SplitFlags(std::uint32_t value, const Game &game,
                                                                   FlagKind kind);
/// A number as C's strtoul reads it: 0x.. hexadecimal, leading 0 octal, else decimal. False: not one, or over 32 bits.
bool ParseFlagNumber(std::string_view text, std::uint32_t &value);

/// Translates the surface and content flags of the shader records: each surfaceparm of `from` gets the bits of the
/// surfaceparm of that name in `to`. A flag that no surfaceparm of `from` names, or whose name `to` lacks, keeps its
/// bits if they mean nothing in `to`; else it is dropped with a warning. Shaders also get the bits that all shaders of
/// `to` have by default and those of `from` do not, unless their surfaceparms clear them. Surfaces of foliage become
/// empty triangle soups, with a warning, if engines of `to` refuse them. Also warns if the lightmap pages of two games
/// of one format differ in size. The records are left to ChangeFormat, the file version to BspFormat.
void ConvertToGame(Bsp &bsp, const Game &from, const Game &to, Log &log);

} // namespace q3
