// GPL-2.0-or-later. Planes between two windings: they bound what can be seen from one through the other.
#pragma once

#include "q3map2/vis/vis_winding.h"

#include <cmath>
#include <span>

namespace q3 {

/// The plane through an edge of `s` (its point `edge` and the next) and a point of `t` that has `s` on its back and `t`
/// in front; sides exchanged if `flip`. False: there is none.
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

/// What SeparatorOfEdge looks for, of all edges of `s` at once and without trying point after point: written to
/// `planes` as far as there is room; returns how many. `normal` is that of the plane of `s`, whose points run
/// counter-clockwise for who it points at. `t` lies on that side, with `behind` on the other. All planes have `s` on
/// their back.
int TangentPlanes(const WindingView &s, const Vec3f &normal, const WindingView &t, bool behind,
                  std::span<VisPlane> planes);

} // namespace q3
