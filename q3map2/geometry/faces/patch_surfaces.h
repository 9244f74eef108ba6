// GPL-2.0-or-later. Draw surfaces of patches.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

namespace q3 {

/// Appends a surface for each patch of the entity. Flat patches get a plane number.
void MakePatchSurfaces(MapEntity &entity, Geometry &geometry, PlaneTable &planes, const BspContext &context);

} // namespace q3
