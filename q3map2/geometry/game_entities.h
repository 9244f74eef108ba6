// GPL-2.0-or-later. Entities of the map source, as written for the game.
#pragma once

#include "q3map2/bspfile/bsp.h"
#include "q3map2/map/bsp_context.h"
#include "q3map2/map/map.h"

#include <string>

namespace q3 {

/// Numbers the models: sets the key `model` of brush entities to *N, and of clones to the value of the named entity.
void NumberModels(Map &map, const BspContext &context);
/// Text of the entities lump: all entities except groups, sky boxes, decals, and the lights and models compiled in.
std::string GameEntities(const Map &map, const BspOptions &options);
/// -onlyents: replaces the entities of the .bsp by the entities of the map. Keys that the tools added to the old
/// worldspawn (command line, version, grid size, how it was lit) are kept.
void ReplaceEntities(Bsp &bsp, Map &map, const BspContext &context);

} // namespace q3
