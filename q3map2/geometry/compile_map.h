// GPL-2.0-or-later. The bsp stage as a whole: a map source to a .bsp.
#pragma once

#include "q3map2/bspfile/bsp.h"
#include "q3map2/map/bsp_context.h"
#include "q3map2/map/map.h"

#include <string>
#include <vector>

namespace q3 {

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
