// GPL-2.0-or-later. The bsp stage as a whole: a map source to a .bsp, its entities, and brushes as text.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/map/bsp_options.h"
#include "q3map2/map/map.h"

#include <string>
#include <vector>

namespace q3 {

/// -autocaulk: a line for each brush of the world, with its number and a letter per side.
std::string CaulkText(const MapEntity &world, const Game &game);
/// -fakemap: the world's brushes as map source.
std::string FakeMapText(const MapEntity &world, const PlaneTable &planes);
/// Warns of each number of records that exceeds what engines can load.
void WarnOfLimits(const Bsp &bsp, const Game &game, Log &log);

/// Numbers the models: sets the key `model` of brush entities to *N, and of clones to the value of the named entity.
void NumberModels(Map &map, const BspContext &context);
/// Text of the entities lump: all entities except groups, sky boxes, decals, and the lights and models compiled in.
/// Numbered switchable lights stay.
std::string GameEntities(const Map &map, const BspContext &context);
/// -onlyents: replaces the entities of the .bsp by the entities of the map. Keys that the tools added to the old
/// worldspawn (command line, version, grid size, how it was lit) are kept. Switchable lights are numbered as by
/// CompileMap.
void ReplaceEntities(Bsp &bsp, Map &map, const BspContext &context);

/// Output of the bsp stage.
struct CompiledMap {
    Bsp bsp;                     ///< without visibility and light
    std::string surfaceFile;     ///< text of the .srf
    std::string portalFile;      ///< text of the .prt; empty: the map leaks
    std::vector<Vec3f> leakLine; ///< points from outside to an entity; empty: the map is sealed
    std::string caulkFile;       ///< with -autocaulk: text of the .caulk, the only output
    int idleAreaPortals = 0;     ///< area portals with one area on both sides
    bool abandoned = false;      ///< the map leaks and -leaktest is on: there is no .bsp
};

/// Compiles the map, which is modified. Throws Error if no entity stands in the open or a limit is exceeded.
CompiledMap CompileMap(Map &map, const BspContext &context);

} // namespace q3
