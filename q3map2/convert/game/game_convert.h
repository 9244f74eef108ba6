// GPL-2.0-or-later. Converts a compiled map of one game for another: surface and content flags.
#pragma once

#include "q3map2/bspfile/bspfile.h"
#include "q3map2/shader/games.h"

namespace q3 {

/// Translates the surface and content flags of the shader records: each surfaceparm of `from` gets the bits of the
/// surfaceparm of that name in `to`. A flag that no surfaceparm of `from` names, or whose name `to` lacks, keeps its
/// bits if they mean nothing in `to`; else it is dropped with a warning. Also warns if the games' lightmap pages differ
/// in size. File version and advertisements are left to BspFormat.
void ConvertToGame(Bsp &bsp, const Game &from, const Game &to, Log &log);

} // namespace q3
