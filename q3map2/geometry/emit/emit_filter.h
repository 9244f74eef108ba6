// GPL-2.0-or-later. Which leafs a surface is in.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/tree/tree.h"

namespace q3 {

/// Adds the surface, number `number` of the .bsp, to each leaf that it reaches and that is not opaque. Returns the
/// number of leafs. `inSkyBox` becomes true if one of them belongs to the sky box.
int FilterSurface(const DrawSurface &surface, int number, Tree &tree, const PlaneTable &planes, bool &inSkyBox);

} // namespace q3
