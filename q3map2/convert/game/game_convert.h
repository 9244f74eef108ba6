// GPL-2.0-or-later. A compiled map of one game for another.
#pragma once

#include "q3map2/bspfile/bspfile.h"
#include "q3map2/shader/games.h"

namespace q3 {

/// Rewrites the surface and content flags of the shader records as `to` numbers them: by the surfaceparms of the same
/// name. Flags without a name stay where `to` does not use their bits; others are dropped, with a warning for each
/// name, and for lightmap pages of another size. File version and advertisements are BspFormat's.
void ConvertToGame(Bsp &bsp, const Game &from, const Game &to, Log &log);

} // namespace q3
