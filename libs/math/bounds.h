// GPL-2.0-or-later. Axis-aligned boxes.
#pragma once

#include "libs/math/vec.h"

#include <limits>

namespace q3 {

/// Axis-aligned box; empty (mins > maxs) until a point is added.
template <typename T> struct Bounds {
    Vec3<T> mins{std::numeric_limits<T>::max(), std::numeric_limits<T>::max(), std::numeric_limits<T>::max()};
    Vec3<T> maxs{std::numeric_limits<T>::lowest(), std::numeric_limits<T>::lowest(), std::numeric_limits<T>::lowest()};

    void Add(const Vec3<T> &p) { mins = Min(mins, p), maxs = Max(maxs, p); }
    void Add(const Bounds &b) { mins = Min(mins, b.mins), maxs = Max(maxs, b.maxs); }
    bool Empty() const { return mins.x > maxs.x || mins.y > maxs.y || mins.z > maxs.z; }
    bool Contains(const Vec3<T> &p) const {
        return p.x >= mins.x && p.y >= mins.y && p.z >= mins.z && p.x <= maxs.x && p.y <= maxs.y && p.z <= maxs.z;
    }
    /// Whether the boxes come within `slack` of each other on every axis.
    bool Touches(const Bounds &b, T slack = 0) const {
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (mins[axis] > b.maxs[axis] + slack || maxs[axis] < b.mins[axis] - slack)
                return false;
        return true;
    }
    Vec3<T> Center() const { return (mins + maxs) * T(0.5); }
    /// Distance from p to the nearest point of the box; 0 inside.
    T Distance(const Vec3<T> &p) const { return Length(Max(Max(mins - p, p - maxs), Vec3<T>{})); }
};

using Boundsf = Bounds<float>;
using Boundsd = Bounds<double>;

} // namespace q3
