// GPL-2.0-or-later. Directions in rings over a hemisphere.
#pragma once

#include "libs/math/vec.h"

#include <vector>

namespace q3 {

/// Azimuths of a ring of floodlight and dirt, and elevations of floodlight.
inline constexpr int kRingAzimuths = 16, kFloodElevations = 4;
/// Half angle of the cone of directions of floodlight and dirt. Degrees.
inline constexpr int kConeDegrees = 88;

/// Unit directions around +z in rings: ring e of n is at (e + 1/2) floor(kConeDegrees / n) degrees from the axis, with
/// `azimuths` even steps around it from +x on. Components that are zero but for rounding are zero, so that rays in the
/// plane of a wall stay in it.
std::vector<Vec3f> HemisphereRings(int elevations, int azimuths);

} // namespace q3
