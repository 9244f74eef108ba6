// GPL-2.0-or-later. Triangulation of polygons.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

namespace q3 {

/// Sets the indexes of a face. First choice is a strip that zigzags across the polygon (with -maxarea, the split with
/// the largest triangles); if that has slivers, a fan around a vertex inserted in the middle.
void TriangulateFace(DrawSurface &surface, const BspContext &context);

} // namespace q3
