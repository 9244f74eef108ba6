// GPL-2.0-or-later. The sparse SH light grid as JSON. See docs/json.md.
#pragma once

#include "q3map2/bspfile/bsp.h"
#include "q3map2/convert/json/convert_json_archive.h"

#include <filesystem>

namespace q3 {

/// Writes the file. Errors: those of JsonWriter.
void WriteJsonSparseGrid(const std::filesystem::path &path, const SparseGridSH &grid, const Game &game);
/// Reads it. Errors: Error with file, member and what was expected; those of CheckSparseGrid.
SparseGridSH ReadJsonSparseGrid(const std::filesystem::path &path, const JsonReadRules &rules);

} // namespace q3
