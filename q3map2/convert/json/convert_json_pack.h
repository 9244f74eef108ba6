// GPL-2.0-or-later. A JSON folder to a compiled map.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/shader/games.h"

#include <filesystem>

namespace q3 {

struct PackJsonOptions {
    bool useFlagNames = false;     ///< bits come from the names in the game's table
    bool dropUnknownFlags = false; ///< with useFlagNames: unknown names are ignored
};

/// Reads what UnpackJson (or the established program's -json -unpack) wrote. The result is validated. Errors: Error
/// with file, member and what was expected.
Bsp PackJson(const std::filesystem::path &folder, const Game &game, const PackJsonOptions &options, Log &log);

} // namespace q3
