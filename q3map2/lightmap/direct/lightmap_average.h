// GPL-2.0-or-later. Averages the light of super luxels into luxels.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Averages super luxels, adds the means to `result` (all passes) and sets `radiosity` (this pass). last: no bounce
/// follows, so `radiosity` is left empty and data that only the passes need is freed.
void AverageLuxels(const SurfaceInputs &in, const SurfacePass &pass, bool last, SurfaceLight &surfaces);

} // namespace q3
