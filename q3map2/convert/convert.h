// GPL-2.0-or-later. What turns a compiled map into something people can read, and back.
#pragma once

#include "q3map2/bspfile/bspfile.h"
#include "q3map2/shader/games.h"

#include <cstdint>
#include <filesystem>

namespace q3 {

struct PackJsonOptions {
    bool useFlagNames = false; ///< bits come from the names in the game's table
    bool skipFlags = false;    ///< with useFlagNames: unknown names are dropped
};

/// Writes every lump as a JSON file into `folder` (made if missing). Streams: memory use does not grow with the lumps.
void UnpackJson(const Bsp &bsp, const Game &game, const std::filesystem::path &folder, Log &log);
/// Reads what UnpackJson (or the established program's -json -unpack) wrote. The result is validated. Errors: Error
/// with file, member and what was expected.
Bsp PackJson(const std::filesystem::path &folder, const Game &game, const PackJsonOptions &options, Log &log);

/// Prints counts and bytes of every lump, as -info does. `fileBytes` is the size on disk.
void PrintBspInfo(const std::filesystem::path &path, const Bsp &bsp, std::uintmax_t fileBytes, Log &log);

/// Renders what the two light grids of `bsp` show: a plan of the map and pairs of spheres, lit by the SH grid and by
/// the legacy grid as an engine does. Errors: no SH grid.
void WriteGridPreview(const std::filesystem::path &png, const Bsp &bsp, Log &log);

} // namespace q3
