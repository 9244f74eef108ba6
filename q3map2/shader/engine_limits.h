// GPL-2.0-or-later. Default limits of the engines of a game.
#pragma once

#include "q3map2/shader/games.h"

namespace q3 {

/// Default of com_hunkMegs, the memory for a map, in MiB. 0: unknown.
int EngineMegabytes(const Game &game);

} // namespace q3
