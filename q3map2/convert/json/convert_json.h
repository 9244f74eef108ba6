// GPL-2.0-or-later. A compiled map to a JSON folder.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/shader/games.h"

#include <filesystem>

namespace q3 {

/// Writes every lump as a JSON file into `folder` (made if missing). Streams: memory use does not grow with the lumps.
void UnpackJson(const Bsp &bsp, const Game &game, const std::filesystem::path &folder, Log &log);

} // namespace q3
