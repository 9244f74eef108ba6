// GPL-2.0-or-later. Fur: copies of a surface stacked along its normals.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"

#include <cstddef>

namespace q3 {

/// Moves the surface to the lowest layer of its shader's fur and appends the other layers. No-op for fur layers.
void MakeFur(std::size_t surface, Geometry &geometry);

} // namespace q3
