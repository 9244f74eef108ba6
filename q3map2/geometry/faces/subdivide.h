// GPL-2.0-or-later. Faces cut by a world-aligned grid, where their shader asks for a maximum size.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

#include <cstddef>

namespace q3 {

/// Replaces each face (from `first` on) whose shader has tessSize by pieces no larger than that. Error: more pieces
/// than -maxmapdrawsurfs allows.
void SubdivideFaces(MapEntity &entity, Geometry &geometry, std::size_t first, const PlaneTable &planes,
                    const BspContext &context);

} // namespace q3
