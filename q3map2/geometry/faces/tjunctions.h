// GPL-2.0-or-later. Repair of T-junctions.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

#include <cstddef>

namespace q3 {

/// Inserts into each face (from `first` on) the vertices of other faces and patches that lie on its edges, so that no
/// cracks show between them. Throws Error for a face with too many vertices.
void FixTJunctions(Geometry &geometry, std::size_t first, const BspContext &context);

} // namespace q3
