// GPL-2.0-or-later. The basis of radiosity normal mapping. McTaggart, Half-Life 2 / Valve Source Shading, 2004.
#pragma once

#include "libs/math/vec.h"

#include <array>

namespace q3 {

/// Orthonormal directions in tangent space: x along the texture coordinate s, y along t (down the image), z off the
/// surface. All rise 35.26 degrees above the surface; their azimuths are 120 degrees apart.
inline constexpr std::array<Vec3f, 3> kRnmBasis{{{0.816496581f, 0, 0.577350269f},
                                                 {-0.408248290f, 0.707106781f, 0.577350269f},
                                                 {-0.408248290f, -0.707106781f, 0.577350269f}}};

} // namespace q3
