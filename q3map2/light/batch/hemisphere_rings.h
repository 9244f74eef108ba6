// GPL-2.0-or-later. Directions in rings over a hemisphere.
#pragma once

#include "libs/math/vec.h"

#include <vector>

namespace q3 {

/// Directions per ring for floodlight and dirt, and number of rings for floodlight.
inline constexpr int kRingAzimuths = 16, kFloodElevations = 4;
/// Half angle of the cone that floodlight and dirt rays fill. Degrees.
inline constexpr int kConeDegrees = 88;

/// Unit directions around +z in rings: ring e is (e + 1/2) floor(kConeDegrees / elevations) degrees from the axis, with
/// `azimuths` even steps that start at +x. Components below rounding error are set to 0, so that rays in the plane of a
/// wall stay in it.
std::vector<Vec3f> HemisphereRings(int elevations, int azimuths);

} // namespace q3
