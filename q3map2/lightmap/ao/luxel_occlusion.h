// GPL-2.0-or-later. Ambient occlusion and sky occlusion of luxels as outputs of -lightmass.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Sets RawLightmap::unoccluded from dirt, if there is any, and under -skyocclusion RawLightmap::skyOcclusion by rays
/// over the hemisphere. Call before the last AverageLuxels, after DirtLuxels.
void FindOcclusion(const SurfaceInputs &in, SurfaceLight &surfaces);

} // namespace q3
