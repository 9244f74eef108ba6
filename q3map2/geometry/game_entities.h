// GPL-2.0-or-later. Entities of the map source as the game gets them.
#pragma once

#include "q3map2/bspfile/bsp.h"
#include "q3map2/map/bsp_context.h"
#include "q3map2/map/map.h"

#include <string>

namespace q3 {

/// Numbers the models: sets the `model` key of each brush entity, and of clones to that of the entity they name.
void NumberModels(Map &map, const BspContext &context);
/// Text of the entities lump: all but groups and the lights, models and decals that are compiled in.
std::string GameEntities(const Map &map, const BspOptions &options);
/// -onlyents: replaces the entities of the .bsp by those of the map. Keys that the tools added to the old worldspawn
/// (command line, version, grid size) are kept.
void ReplaceEntities(Bsp &bsp, Map &map, const BspContext &context);

} // namespace q3
