// GPL-2.0-or-later. Copies of surfaces with another shader: cel, clone and back shaders.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

#include <cstddef>

namespace q3 {

/// Appends the copies that shaders and cel shader settings demand of the surfaces from `first` on.
void MakeDerivedSurfaces(Geometry &geometry, std::size_t first, const BspContext &context);

} // namespace q3
