// GPL-2.0-or-later. What lighting needs to know of each draw surface beyond the .bsp record.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/shader/shader.h"

#include <string_view>
#include <vector>

namespace q3 {

struct SurfaceEntry {
    const ShaderInfo *shader = nullptr;
    Vec3f origin;            ///< of the entity whose model holds it: vertices are relative to it
    int castShadows = 1;     ///< shadow group; 0 casts none
    float longestCurve = 0;  ///< patches: decides the tessellation. Game units
    bool skyBoxCopy = false; ///< lit by its parent surface; never casts shadows
    int skyIndex = -1;       ///< number of the sky among those that shine; set with the lights
};

/// One entry per draw surface.
using SurfaceTable = std::vector<SurfaceEntry>;

/// `srfText` is the surface file that the bsp stage wrote beside the map, empty when there is none: then everything is
/// derived from the surfaces themselves. Errors: a malformed surface file.
SurfaceTable MakeSurfaceTable(const Bsp &bsp, const std::vector<Entity> &entities, std::string_view srfText,
                              std::string_view srfName, ShaderLibrary &library, Log &log);

} // namespace q3
