// GPL-2.0-or-later. What is between two surfaces of one plane.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

enum class SurfaceGap {
    Touching, ///< no gap
    NoWall,   ///< farther apart than `reach`, or with only open space in between
    Wall      ///< a solid is on the shortest way from one to the other
};

/// What is between draw surfaces a and b, which lie in one plane with that normal. reach: game units.
SurfaceGap GapBetween(const SurfaceInputs &in, const SurfaceLight &surfaces, int a, int b, const Vec3f &normal,
                      float reach);

} // namespace q3
