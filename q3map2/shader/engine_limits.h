// GPL-2.0-or-later. What the engines of a game hold by default.
#pragma once

#include "q3map2/shader/games.h"

namespace q3 {

/// Memory of the game's engines for a map, in MiB: the default of com_hunkMegs. 0: not known.
int EngineMegabytes(const Game &game);

} // namespace q3
