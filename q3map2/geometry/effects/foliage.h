// GPL-2.0-or-later. Foliage surfaces: one model and its instances.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

#include <cstddef>

namespace q3 {

/// Appends foliage surfaces for the models that the shader of the surface scatters over it.
void MakeFoliage(std::size_t surface, Geometry &geometry, const BspContext &context);

} // namespace q3
