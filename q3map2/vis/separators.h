// GPL-2.0-or-later. Separating planes of two windings, which bound the region seen from one winding through the other.
#pragma once

#include "q3map2/vis/vis_winding.h"

#include <cmath>
#include <span>

namespace q3 {

/// The plane through an edge of `s` (points `edge` and `edge` + 1) and a point of `t` that has `s` behind it and `t` in
/// front; with `flip`, facing the other way. False: no point of `t` gives such a plane.
inline bool SeparatorOfEdge(const WindingView &s, const WindingView &t, int edge, bool flip, VisPlane &plane) {
    const int after = edge + 1 == s.count ? 0 : edge + 1;
    const Vec3f a = s.Point(edge), b = s.Point(after);
    for (int j = 0; j < t.count; ++j) {
        if (!PlaneOfPoints(a, t.Point(j), b, plane))
            continue;
        int k = 0;
        float side = 0;
        for (; k < s.count; ++k)
            if (k != edge && k != after && std::abs(side = plane.Distance(s.Point(k))) >= kOnEpsilon)
                break;
        if (k == s.count)
            continue;
        if (side > 0)
            plane = plane.Flipped();
        bool front = false, back = false;
        for (k = 0; k < t.count && !back; ++k) {
            if (k == j)
                continue;
            const float d = plane.Distance(t.Point(k));
            back = d <= -kOnEpsilon;
            front |= d >= kOnEpsilon;
        }
        if (back || !front)
            continue;
        if (flip)
            plane = plane.Flipped();
        return true;
    }
    return false;
}

/// The planes of SeparatorOfEdge for all edges of `s`, found in one pass over the points of `t` per edge. `normal` is
/// the unit normal of `s`; seen from its tip the points of `s` run counterclockwise. `t` lies on that side, or on the
/// opposite one with `behind`. All planes have `s` behind them. Writes as many as fit into `planes` and returns
/// their number.
int TangentPlanes(const WindingView &s, const Vec3f &normal, const WindingView &t, bool behind,
                  std::span<VisPlane> planes);

} // namespace q3
