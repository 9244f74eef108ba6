// GPL-2.0-or-later. Terrain from index maps.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

#include <cstddef>

namespace q3 {

/// For faces and patches (from `first` on) with an indexed shader: sets heights, vertex alpha and shader by the index
/// map of their entity.
void ApplyIndexedTerrain(const MapEntity &entity, Geometry &geometry, std::size_t first, const BspContext &context);

} // namespace q3
