// GPL-2.0-or-later. Cuts faces of shaders with tessSize by a world-aligned grid.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

#include <cstddef>

namespace q3 {

/// Replaces each face (from `first` on) whose shader has tessSize by pieces no larger than that. Throws Error for
/// more pieces than -maxmapdrawsurfs allows.
void SubdivideFaces(MapEntity &entity, Geometry &geometry, std::size_t first, const PlaneTable &planes,
                    const BspContext &context);

} // namespace q3
