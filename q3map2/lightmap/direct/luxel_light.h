// GPL-2.0-or-later. Direct light on luxels.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Lights all mapped luxels by `lights` (from SetupEnvelopes for surfaces) and ambient light: sets light,
/// directional, filled, styles and directions. Adds the work done to `counts`.
void LightLuxels(const SurfaceInputs &in, const std::vector<Light> &lights, const SurfacePass &pass,
                 SurfaceLight &surfaces, ContributionCounts &counts);

} // namespace q3
