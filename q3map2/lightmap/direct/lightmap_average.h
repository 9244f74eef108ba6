// GPL-2.0-or-later. The last steps of a pass over luxels: dirt and floodlight, light from neighbors for luxels
// without a position, and averages of super luxels.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Adds floodlight (direct pass only), multiplies by dirt, and then gives luxels that are not mapped (with
/// q3map_splotchFix also luxels not above ambient light in every channel) the mean of their mapped neighbors.
void FinishLuxels(const SurfaceInputs &in, const SurfacePass &pass, SurfaceLight &surfaces);

/// What happens to data that only the passes need.
enum class PassData {
    Keep,
    Free ///< no bounce follows: it is freed, and `radiosity` stays empty
};
/// Averages super luxels, adds the means to `result` (all passes) and sets `radiosity` (this pass).
void AverageLuxels(const SurfaceInputs &in, const SurfacePass &pass, PassData data, SurfaceLight &surfaces);

} // namespace q3
