// GPL-2.0-or-later. Adds draw surfaces to the leafs that they reach.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/tree/tree.h"

namespace q3 {

/// Adds the surface, with index `number` in the .bsp, to each open leaf that it reaches. Returns 0 if there is none.
/// `inSkyBox` becomes true if one of the leafs belongs to the sky box.
int FilterSurface(const DrawSurface &surface, int number, Tree &tree, const PlaneTable &planes, bool &inSkyBox);

} // namespace q3
