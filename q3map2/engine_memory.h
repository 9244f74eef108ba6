// GPL-2.0-or-later. Whether the engines of a game can load a .bsp with the memory that they have by default.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/shader/games.h"

#include <cstdint>
#include <filesystem>

namespace q3 {

/// Bytes of hunk memory (com_hunkMegs) that an engine needs while it loads the file. It reads the whole file into the
/// hunk and copies the lumps that it knows, which excludes BSPX lumps. docs/troubleshooting.md has the measurement.
std::uint64_t EngineMemoryFor(const Bsp &bsp, std::uint64_t fileBytes);

/// Warns if the file that was just written needs more than engines of the game have by default, and says how to make it
/// smaller.
void WarnOfEngineMemory(const std::filesystem::path &bspPath, const Bsp &bsp, const Game &game, Log &log);

} // namespace q3
