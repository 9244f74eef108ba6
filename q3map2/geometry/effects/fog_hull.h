// GPL-2.0-or-later. The fog hull: a box around the map.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

namespace q3 {

/// Appends the fog hull if the world key _foghull names its shader. To be called once the fogs are known.
void MakeFogHull(const Map &map, Geometry &geometry, const BspContext &context);

} // namespace q3
