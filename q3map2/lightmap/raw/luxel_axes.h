// GPL-2.0-or-later. Axes of projected raw lightmaps.
#pragma once

#include "libs/math/vec.h"

#include <cmath>
#include <cstddef>

namespace q3 {

/// World axes (0 x, 1 y, 2 z) of a projected raw lightmap: u to the next column, v to the next row, `along` projection.
struct LuxelAxes {
    std::size_t u = 0, v = 1, along = 2;
};

/// Projection along the largest component of `axis`; ties prefer z, then x.
inline LuxelAxes AxesOf(const Vec3f &axis) {
    const float x = std::abs(axis.x), y = std::abs(axis.y), z = std::abs(axis.z);
    if (z >= x && z >= y)
        return {0, 1, 2};
    return x >= y ? LuxelAxes{1, 2, 0} : LuxelAxes{0, 2, 1};
}

/// p projected along a world axis onto the plane normal . p = dist; normal[along] is not zero.
inline Vec3f OntoPlane(Vec3f p, std::size_t along, const Vec3f &normal, float dist) {
    p[along] -= (Dot(normal, p) - dist) / normal[along];
    return p;
}

} // namespace q3
