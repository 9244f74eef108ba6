// GPL-2.0-or-later. Ambient cubes as JSON. See docs/json.md.
#pragma once

#include "q3map2/bspfile/bsp.h"
#include "q3map2/convert/json/convert_json_archive.h"

#include <filesystem>

namespace q3 {

/// Writes the file. Errors: those of JsonWriter.
void WriteJsonCubes(const std::filesystem::path &path, const AmbientCubes &cubes, const Game &game);
/// Reads it. Errors: Error with file, member and what was expected.
AmbientCubes ReadJsonCubes(const std::filesystem::path &path, const JsonReadRules &rules);

} // namespace q3
