// GPL-2.0-or-later. -dirty: ambient occlusion of luxels.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Sets the dirt of all raw lightmaps: the factor, 0 to 1, that their light is multiplied by. Does nothing without
/// -dirty.
void DirtLuxels(const SurfaceInputs &in, SurfaceLight &surfaces);

} // namespace q3
