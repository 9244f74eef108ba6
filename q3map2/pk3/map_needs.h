// GPL-2.0-or-later. What a map asks the engine and the game for.
#pragma once

#include "q3map2/bspfile/bspfile.h"
#include "q3map2/pk3/wanted_list.h"
#include "q3map2/shader/games.h"

#include <string_view>
#include <vector>

namespace q3 {

/// Shaders, sounds and models that maps name.
struct MapNeeds {
    WantedList shaders, sounds, models;
    WantedList externalPages; ///< lightmaps that engines load by number, with folder and .tga
};

/// Adds the needs of a map: shaders of surfaces that are drawn, of fogs and remappings, and its level shot; music and
/// sounds of entities; models that entities show in the game, which the compiler has not built in. Sounds that the
/// game's code knows by name, and the level shot, are not required. `name`: of the map, without folder and extension.
void AddNeeds(const Bsp &bsp, std::string_view name, const Game &game, MapNeeds &needs);

/// Shaders of all surfaces of an MD3 model, as engines look them up; nothing for other formats and damaged files.
std::vector<std::string> ShadersOfMd3(std::span<const std::byte> file);
/// Shaders of a skin: what stands after the comma of each line.
std::vector<std::string> ShadersOfSkin(std::string_view text);

} // namespace q3
