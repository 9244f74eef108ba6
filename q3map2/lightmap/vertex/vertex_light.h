// GPL-2.0-or-later. Light at the vertices of surfaces.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Lights the vertices of all surfaces: surfaces without a lightmap by `lights` (from SetupEnvelopes for surfaces),
/// other surfaces from the nearest luxels of their lightmap. Adds the work done to `counts`.
void LightVertices(const SurfaceInputs &in, const std::vector<Light> &lights, const SurfacePass &pass,
                   SurfaceLight &surfaces, ContributionCounts &counts);

} // namespace q3
