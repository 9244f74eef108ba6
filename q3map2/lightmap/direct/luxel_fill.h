// GPL-2.0-or-later. The last step of a pass over luxels: floodlight, dirt, and luxels without light of their own.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Adds floodlight (direct pass only), multiplies by dirt, and then gives luxels that are not mapped (with
/// q3map_splotchFix also luxels not above ambient light in every channel) the mean of their mapped neighbors.
void FinishLuxels(const SurfaceInputs &in, const SurfacePass &pass, SurfaceLight &surfaces);

} // namespace q3
