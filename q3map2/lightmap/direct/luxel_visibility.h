// GPL-2.0-or-later. Shadow maps: the visibility of named lights at luxels.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Sets RawLightmap::visibility for each targetname in LightmapOptions::shadowMaps: arriving over unshadowed light,
/// summed over all lights of that name, such as the samples of one light. `lights`: from SetupEnvelopes for surfaces. A
/// name that no light has is a warning. Call before the last AverageLuxels.
void FindVisibility(const SurfaceInputs &in, const std::vector<Light> &lights, SurfaceLight &surfaces,
                    ContributionCounts &counts);

} // namespace q3
