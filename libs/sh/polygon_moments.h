// GPL-2.0-or-later. Moments of the directions in which a planar polygon is seen, in closed form.
#pragma once

#include "libs/math/vec.h"
#include "libs/sh/sh.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace q3 {

/// Integrals over the solid angle that a polygon covers: of 1, of w and of w w^T, w the unit direction.
struct PolygonMoments {
    double solidAngle = 0;
    Vec3d first;
    double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, xz = 0;

    /// Integral of Y[k] over the solid angle.
    ShVector Projection() const { return ShFromMoments<double>(solidAngle, first, xy, yz, zz, xz, xx - yy); }
};

/// atan2(y, x) for y >= 0 or x > 0: by its series where that is exact to 1e-13, which is many times faster there.
inline double FastAtan2(double y, double x) {
    if (!(x > 0 && std::abs(y) < 0.125 * x))
        return std::atan2(y, x);
    const double t = y / x, t2 = t * t;
    return t * (1 + t2 * (-1.0 / 3 + t2 * (1.0 / 5 + t2 * (-1.0 / 7 + t2 * (1.0 / 9 + t2 * (-1.0 / 11 + t2 / 13))))));
}

/// Signed solid angle of the triangle with corners a, b, c as seen from the origin: positive when they run clockwise.
/// Van Oosterom and Strackee, The Solid Angle of a Plane Triangle, 1983.
inline double TriangleSolidAngle(const Vec3d &a, const Vec3d &b, const Vec3d &c) {
    const double la = Length(a), lb = Length(b), lc = Length(c);
    const double volume = Dot(a, Cross(b, c));
    const double denominator = la * lb * lc + Dot(a, b) * lc + Dot(b, c) * la + Dot(c, a) * lb;
    return volume == 0 ? 0 : 2 * FastAtan2(volume, denominator);
}

/// Moments of the polygon `corners` (convex, planar) as seen from `p`. Corners run clockwise as seen from the front;
/// from the back, from the polygon's own plane, or for a degenerate polygon everything is zero.
///
/// With D the Laplacian of the sphere, D(w_i) = -2 w_i and D(w_i w_j) = 2 delta_ij - 6 w_i w_j, so the divergence
/// theorem turns both moments into integrals along the edges, which are arcs of great circles with a constant outward
/// normal.
inline PolygonMoments MomentsOfPolygon(std::span<const Vec3f> corners, const Vec3d &p) {
    PolygonMoments m;
    if (corners.size() < 3)
        return m;
    const Vec3d first = Vec3d(corners[0]) - p;
    for (std::size_t i = 2; i < corners.size(); ++i)
        m.solidAngle += TriangleSolidAngle(first, Vec3d(corners[i - 1]) - p, Vec3d(corners[i]) - p);
    if (!(m.solidAngle > 0))
        return {};

    Vec3d previous = Normalize(Vec3d(corners.back()) - p);
    for (const Vec3f &corner : corners) {
        const Vec3d current = Normalize(Vec3d(corner) - p);
        const Vec3d across = Cross(previous, current);
        const double sine = Length(across), cosine = Dot(previous, current);
        // An arc of no length adds nothing; one of half a turn passes through p, which then lies in the polygon's
        // plane.
        if (sine > 1e-14) {
            const Vec3d outward = across / -sine; // clockwise corners: the inside is to the right of each edge
            const double angle = FastAtan2(sine, cosine);
            const Vec3d arc = (previous + current) * (sine / (1 + cosine)); // integral of w along the arc
            m.first -= outward * (angle * 0.5);
            m.xx -= arc.x * outward.x / 3, m.yy -= arc.y * outward.y / 3, m.zz -= arc.z * outward.z / 3;
            m.xy -= (arc.x * outward.y + arc.y * outward.x) / 6;
            m.yz -= (arc.y * outward.z + arc.z * outward.y) / 6;
            m.xz -= (arc.x * outward.z + arc.z * outward.x) / 6;
        }
        previous = current;
    }
    m.xx += m.solidAngle / 3, m.yy += m.solidAngle / 3, m.zz += m.solidAngle / 3;
    return m;
}

} // namespace q3
