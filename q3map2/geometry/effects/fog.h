// GPL-2.0-or-later. Fog volumes.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

#include <vector>

namespace q3 {

/// Fog volumes of the map. `defaultFog` becomes the index of the global fog, or stays -1. Error: more than engines
/// can load.
std::vector<MapFog> CollectFogs(const Map &map, const BspContext &context, int &defaultFog);
/// Cuts faces and patches of the world at the borders of fog volumes and sets fogNum of what lies inside.
void FogWorldSurfaces(Map &map, Geometry &geometry, PlaneTable &planes, const BspContext &context);
/// Fog number for a surface of a brush entity with that origin.
int FogOfModelSurface(const DrawSurface &surface, const Vec3f &origin, const Map &map, const Geometry &geometry);

} // namespace q3
