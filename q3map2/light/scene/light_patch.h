// GPL-2.0-or-later. Patches of a .bsp as meshes.
#pragma once

#include "libs/math/patch_mesh.h"
#include "q3map2/bspfile/bspfile.h"

namespace q3 {

/// The mesh of a patch; longestCurve (game units) determines how finely it is tessellated.
Mesh TessellatePatch(const Bsp &bsp, const bspDrawSurface_t &surface, float longestCurve);

/// Longest curve of the patch from its control points, for a map without a .srf file.
float LongestCurve(const Bsp &bsp, const bspDrawSurface_t &surface);

} // namespace q3
