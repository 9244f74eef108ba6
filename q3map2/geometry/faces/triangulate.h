// GPL-2.0-or-later. Triangulation of polygons.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

namespace q3 {

/// Sets the indexes of a face. Tries, until one has no slivers: with -maxarea the split into the largest triangles,
/// then a strip that zigzags across the polygon, then a fan around a vertex inserted in the middle.
void TriangulateFace(DrawSurface &surface, const BspContext &context);

} // namespace q3
