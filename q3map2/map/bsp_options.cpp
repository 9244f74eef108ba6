// GPL-2.0-or-later. Options of the bsp stage.
#include "q3map2/map/bsp_options.h"

#include "q3map2/map/bsp_settings.h"

#include <algorithm>

namespace q3 {

BspOptions ParseBspOptions(Arguments &arguments, const Game &game, Log &log) {
    BspOptions o;
    o.keepLights = game.keepLights;
    o.maxSurfaceVerts = game.maxSurfaceVerts;
    o.maxVertexLitVerts = game.maxVertexLitVerts;
    o.maxSurfaceIndexes = game.maxSurfaceIndexes;
    o.sRgbColor = game.sRgbColor;
    TakeSettings(BspSettings(), o, arguments, log);
    o.maxVertexLitVerts = std::max(o.maxVertexLitVerts, o.maxSurfaceVerts);
    o.meta |= o.patchMeta; // only the meta step draws meshes of patches
    WarnWithoutEffect(o.withoutEffect, log);
    return o;
}

} // namespace q3
