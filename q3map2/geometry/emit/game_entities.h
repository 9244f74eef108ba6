// GPL-2.0-or-later. Entities of the map source, as written for the game.
#pragma once

#include "q3map2/bspfile/bsp.h"
#include "q3map2/map/bsp_options.h"
#include "q3map2/map/map.h"

#include <string>

namespace q3 {

/// Numbers the models and switchable lights: sets the key `model` of brush entities to *N, and of clones to the value
/// of the named entity. Errors: light styles that engines do not have.
void NumberEntities(Map &map, const BspContext &context);
/// Text of the entities lump: all entities except groups, sky boxes, decals, and the lights and models compiled in.
/// Numbered switchable lights stay.
std::string GameEntities(const Map &map, const BspContext &context);
/// -onlyents: replaces the entities of the .bsp by the entities of the map. Keys that the tools added to the old
/// worldspawn (command line, version, grid size, how it was lit) are kept. Switchable lights are numbered as by
/// CompileMap.
void ReplaceEntities(Bsp &bsp, Map &map, const BspContext &context);

} // namespace q3
