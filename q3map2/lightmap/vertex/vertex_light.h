// GPL-2.0-or-later. Light at the vertices of surfaces.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Lights the vertices of all surfaces: those without a lightmap by `lights` (of SetupEnvelopes for surfaces), the
/// others from the nearest luxels of their lightmap. Adds the work done to `counts`.
void LightVertices(const SurfaceInputs &in, const std::vector<Light> &lights, const SurfacePass &pass,
                   SurfaceLight &surfaces, ContributionCounts &counts);

} // namespace q3
