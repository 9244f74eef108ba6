// GPL-2.0-or-later. Vectors as colors, for debug views.
#pragma once

#include "libs/math/bounds.h"

#include <algorithm>

namespace q3 {

/// A unit vector as a color: components -1 to 1 become 0 to 255.
inline Vec3f VectorColor(const Vec3f &v) {
    return (v + Vec3f{1, 1, 1}) * 127.5f;
}

/// A position as a color: its coordinates in the box, 0 to 255.
inline Vec3f PositionColor(const Vec3f &position, const Boundsf &box) {
    Vec3f color;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float size = box.maxs[axis] - box.mins[axis];
        color[axis] = size > 0 ? 255 * std::clamp((position[axis] - box.mins[axis]) / size, 0.0f, 1.0f) : 0;
    }
    return color;
}

} // namespace q3
