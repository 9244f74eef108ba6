// GPL-2.0-or-later. Light of super luxels becomes light of luxels.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Averages super luxels into `result`, to which passes add up, and `radiosity`, that of this pass. `last`: no bounce
/// follows, so what only passes need is freed.
void AverageLuxels(const SurfaceInputs &in, const SurfacePass &pass, bool last, SurfaceLight &surfaces);

} // namespace q3
