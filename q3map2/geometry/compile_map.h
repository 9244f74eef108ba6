// GPL-2.0-or-later. The bsp stage as a whole: a map source to a .bsp.
#pragma once

#include "q3map2/geometry/surface.h"

#include <string>
#include <vector>

namespace q3 {

struct CompiledMap {
    Bsp bsp;                     ///< without visibility and light
    std::string surfaceFile;     ///< text of the .srf
    std::string portalFile;      ///< text of the .prt; empty: the map leaks
    std::vector<Vec3f> leakLine; ///< from outside to an entity; empty: the map is sealed
    std::string caulkFile;       ///< with -autocaulk: text of the .caulk; nothing else is there
    bool abandoned = false;      ///< a leak under -leaktest: there is no .bsp
};

/// Changes the map on the way. Errors: Error, for maps without an entity in the open and for exceeded limits.
CompiledMap CompileMap(Map &map, const BspContext &context);

/// Numbers models: gives each brush entity its `model` key, clones that of what they copy. entity_models.cpp
void NumberModels(Map &map, const BspContext &context);
/// Text of the entities that the game gets: without lights, models and decals that are compiled in, and groups.
std::string GameEntities(const Map &map, const BspOptions &options);
/// -onlyents: the entities of the map in place of those of the .bsp, with what the tools noted in the world's.
void ReplaceEntities(Bsp &bsp, Map &map, const BspContext &context);

/// map_text.cpp. -autocaulk: for each brush of the world its number and a letter a side.
std::string CaulkText(const MapEntity &world);
/// -fakemap: the world's brushes as map source.
std::string FakeMapText(const MapEntity &world, const PlaneTable &planes);
/// Warns of counts that engines cannot load.
void WarnOfLimits(const Bsp &bsp, Log &log);

} // namespace q3
