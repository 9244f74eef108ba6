// GPL-2.0-or-later. Portals as visible surfaces (-debugportals).
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/tree/tree.h"

namespace q3 {

/// Appends a translucent polygon for each passable portal, each in another color.
void MakePortalSurfaces(const Tree &tree, Geometry &geometry, const BspContext &context);

} // namespace q3
