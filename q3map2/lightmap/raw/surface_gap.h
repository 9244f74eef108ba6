// GPL-2.0-or-later. What is between two surfaces of one plane.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

enum class SurfaceGap {
    Touching, ///< no gap
    Far,      ///< farther apart than asked, or only air is between them
    Wall      ///< a solid is on the shortest way from one to the other
};

/// What is between draw surfaces a and b of the plane with that normal, if their distance is at most `reach` game
/// units.
SurfaceGap GapBetween(const SurfaceInputs &in, const SurfaceLight &surfaces, int a, int b, const Vec3f &normal,
                      float reach);

} // namespace q3
