// GPL-2.0-or-later. Colors.
#pragma once

#include "libs/math/vec.h"

namespace q3 {

/// Luma of an RGB color by the weights of Rec. 601, as map compilers use them on linear light too.
inline float Luminance(const Vec3f &color) {
    return 0.2989f * color.x + 0.587f * color.y + 0.114f * color.z;
}

} // namespace q3
