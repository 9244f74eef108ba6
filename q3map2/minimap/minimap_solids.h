// GPL-2.0-or-later. Thickness of the solids of a map along vertical lines. Internal to minimaps.
#pragma once

#include "libs/math/bounds.h"
#include "libs/math/winding.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/shader/shader_library.h"

#include <span>
#include <vector>

namespace q3 {

/// A convex solid: what is behind all planes.
struct MinimapSolid {
    std::vector<Plane> planes;
    Boundsd bounds; ///< of the planes along x and y; infinite where there are none

    /// Length of the vertical line through (x, y) in the solid, game units.
    double Thickness(double x, double y) const;
};

/// World brushes with a solid side and without a sky side.
std::vector<MinimapSolid> MinimapSolids(const Bsp &bsp, ShaderLibrary &library);

} // namespace q3
