// GPL-2.0-or-later. The position, normal and cluster at which each luxel is lit.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Sets positions, normals and luxelClusters of all raw lightmaps. Logs how many luxels got a position on a surface
/// (mapped), and how many found only positions inside solids or in clusters that do not see the surface (occluded).
void MapLuxels(const SurfaceInputs &in, SurfaceLight &surfaces);

} // namespace q3
