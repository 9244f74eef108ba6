// GPL-2.0-or-later. The bsp stage as a whole: a map source to a .bsp, and brushes as text.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/map/bsp_options.h"
#include "q3map2/map/map.h"
#include "q3map2/tree/flood.h"

#include <functional>
#include <string>
#include <vector>

namespace q3 {

/// -autocaulk: a line for each brush of the world, with its number and a letter per side.
std::string CaulkText(const MapEntity &world, const Game &game);
/// -fakemap: the world's brushes as map source.
std::string FakeMapText(const MapEntity &world, const PlaneTable &planes);
/// Warns of each number of records that exceeds what engines can load.
void WarnOfLimits(const Bsp &bsp, const Game &game, Log &log);

/// Output of the bsp stage.
struct CompiledMap {
    Bsp bsp;                           ///< without visibility and light
    std::string surfaceFile;           ///< text of the .srf
    std::string portalFile;            ///< text of the .prt; empty: the map leaks
    std::vector<Vec3f> leakLine;       ///< points from outside to an entity; empty: the map is sealed
    std::string caulkFile;             ///< with -autocaulk: text of the .caulk, the only output
    int idleAreaPortals = 0;           ///< area portals with one area on both sides
    std::vector<FloodRegions> regions; ///< of the trees, if the context wants them
    bool abandoned = false;            ///< the map leaks and -leaktest is on: there is no .bsp
};

/// Compiles all but the entities of the .bsp. Those of the map have been numbered (NumberEntities). Modifies the map.
/// Throws Error if no entity stands in the open or a limit is exceeded.
CompiledMap CompileGeometry(Map &map, const BspContext &context);

using GeometryMaker = std::function<CompiledMap(Map &, const BspContext &)>;
/// Compiles the map, which is modified. makeGeometry: CompileGeometry, or what knows its result. Throws Error as
/// CompileGeometry.
CompiledMap CompileMap(Map &map, const BspContext &context, const GeometryMaker &makeGeometry = CompileGeometry);

} // namespace q3
