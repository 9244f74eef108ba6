// GPL-2.0-or-later. Luxels in walls that the texture filter shows on both sides.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Gives luxels of a planar lightmap whose center is in a wall, and which are shown on several sides of it, the least
/// light of these sides: light from another side would come through the wall.
void FillWallLuxels(const BspSpace &space, RawLightmap &raw);

} // namespace q3
