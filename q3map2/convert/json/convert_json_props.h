// GPL-2.0-or-later. Light of static props as JSON. See docs/json.md.
#pragma once

#include "q3map2/bspfile/prop_light.h"
#include "q3map2/shader/games.h"

#include <filesystem>
#include <optional>
#include <string>

namespace q3 {

/// Decodes a prop light lump for PropLight.json. Empty: the lump stays in hexadecimal; if that is because it is
/// damaged, `fault` says why.
std::optional<PropLight> JsonPropLight(const BspxLump &lump, std::string &fault);
/// Writes PropLight.json. Errors: as JsonWriter.
void WriteJsonProps(const std::filesystem::path &path, const PropLight &light, const Game &game);
/// Reads PropLight.json. Errors: Error with file, member and what was expected.
PropLight ReadJsonProps(const std::filesystem::path &path);

} // namespace q3
