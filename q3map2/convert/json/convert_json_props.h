// GPL-2.0-or-later. Light of static props as JSON. See docs/json.md.
#pragma once

#include "q3map2/bspfile/prop_light.h"
#include "q3map2/shader/games.h"

#include <filesystem>
#include <optional>
#include <string>

namespace q3 {

/// The light of props of a lump that PropLight.json can hold; empty: the lump stays in hexadecimal. `fault`: why, if it
/// is damaged.
std::optional<PropLight> JsonPropLight(const BspxLump &lump, std::string &fault);
/// Writes the file. Errors: those of JsonWriter.
void WriteJsonProps(const std::filesystem::path &path, const PropLight &light, const Game &game);
/// Reads it. Errors: Error with file, member and what was expected.
PropLight ReadJsonProps(const std::filesystem::path &path);

} // namespace q3
