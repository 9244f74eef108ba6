// GPL-2.0-or-later. Fog volumes.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

#include <vector>

namespace q3 {

/// Fog volumes of the map. `defaultFog` becomes the index of the global fog, or -1 without one. Throws Error if the
/// world key _fog names a shader without fogparms. Warns of more fogs than engines draw.
std::vector<MapFog> CollectFogs(const Map &map, const BspContext &context, int &defaultFog);
/// Cuts faces and patches of the world at the borders of fog volumes and sets fogNum of the parts inside.
void FogWorldSurfaces(Map &map, Geometry &geometry, PlaneTable &planes, const BspContext &context);
/// Index of the fog volume that overlaps the bounds of the surface most, or the default fog. `origin`: origin of the
/// entity, to which the surface is relative.
int FogOfModelSurface(const DrawSurface &surface, const Vec3f &origin, const Map &map, const Geometry &geometry);

} // namespace q3
