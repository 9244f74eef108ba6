// GPL-2.0-or-later. Moments of the directions in which a planar polygon is seen, in closed form.
#pragma once

#include "libs/math/vec.h"
#include "libs/sh/sh.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>
#include <utility>

namespace q3 {

/// Integrals over the solid angle that a polygon covers: of 1, of w and of w w^T, w the unit direction.
struct PolygonMoments {
    double solidAngle = 0;
    Vec3d first;
    double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, xz = 0;

    /// Adds solid angle `w` around the unit direction d.
    void Add(const Vec3d &d, double w) {
        solidAngle += w;
        first += d * w;
        xx += d.x * d.x * w, yy += d.y * d.y * w, zz += d.z * d.z * w;
        xy += d.x * d.y * w, yz += d.y * d.z * w, xz += d.x * d.z * w;
    }
    /// Integral of Y[k] over the solid angle.
    SHVector Projection() const { return SHFromMoments<double>(solidAngle, first, xy, yz, zz, xz, xx - yy); }
};

/// atan2(y, x); for small angles by its series, exact to 1e-13 and many times faster.
inline double FastAtan2(double y, double x) {
    if (!(x > 0 && std::abs(y) < 0.125 * x))
        return std::atan2(y, x);
    const double t = y / x, t2 = t * t;
    return t * (1 + t2 * (-1.0 / 3 + t2 * (1.0 / 5 + t2 * (-1.0 / 7 + t2 * (1.0 / 9 + t2 * (-1.0 / 11 + t2 / 13))))));
}

/// A complex number whose argument is half the signed solid angle of the triangle with corners a, b, c (of lengths la,
/// lb, lc) seen from the origin: positive when they run clockwise. `normal` is b x c, or (b - a) x (c - a), which loses
/// fewer digits for small triangles far away.
/// Van Oosterom and Strackee, The Solid Angle of a Plane Triangle, 1983.
inline std::complex<double> HalfSolidAngle(const Vec3d &a, double la, const Vec3d &b, double lb, const Vec3d &c,
                                           double lc, const Vec3d &normal) {
    return {la * lb * lc + Dot(a, b) * lc + Dot(b, c) * la + Dot(c, a) * lb, Dot(a, normal)};
}

/// Signed solid angle of a triangle as seen from the origin, -2 pi to 2 pi.
inline double TriangleSolidAngle(const Vec3d &a, const Vec3d &b, const Vec3d &c) {
    const auto half = HalfSolidAngle(a, Length(a), b, Length(b), c, Length(c), Cross(b - a, c - a));
    return half.imag() == 0 ? 0 : 2 * FastAtan2(half.imag(), half.real());
}

/// Size, distance and height of a polygon relative to the receiver p, for the choice of formulas.
struct PolygonAspect {
    Vec3d normal;               ///< unit, away from p if p is in front; zero for a polygon without area
    double sizeSquared = 0;     ///< of the longest distance from the first corner to another
    double distanceSquared = 0; ///< of the distance from p to the first corner
    double height = 0;          ///< of p over the plane; negative behind

    PolygonAspect(std::span<const Vec3f> corners, const Vec3d &p) {
        const Vec3d origin(corners[0]), first = origin - p;
        Vec3d area, middle, last = Vec3d(corners[1]) - origin;
        sizeSquared = Dot(last, last), middle = last;
        for (std::size_t i = 2; i < corners.size(); ++i) {
            const Vec3d next = Vec3d(corners[i]) - origin;
            area += Cross(last, next), middle += next;
            sizeSquared = std::max(sizeSquared, Dot(next, next));
            last = next;
        }
        normal = Normalize(area);
        distanceSquared = Dot(first, first);
        height = Dot(first + middle / double(corners.size()), normal);
    }
};

/// Adds the triangle a, a + ab, a + ac, seen from the origin from at least 64 times its size, by Radon's seven
/// points: exact for polynomials of degree 5, with an error below 1e-10 of the solid angle from there.
inline void AddFarTriangle(PolygonMoments &m, const Vec3d &a, const Vec3d &ab, const Vec3d &ac) {
    constexpr double kRoot15 = 3.872983346207417;
    constexpr double kInner = (6 - kRoot15) / 21, kOuter = (6 + kRoot15) / 21;
    constexpr double kInnerWeight = (155 - kRoot15) / 1200, kOuterWeight = (155 + kRoot15) / 1200;
    const double areaTimesHeight = Dot(a, Cross(ab, ac)) * 0.5; // d omega = height dA / |x|^3
    const auto add = [&](double b, double c, double weight) {   // barycentric coordinates
        const Vec3d at = a + ab * b + ac * c;
        const double inverse = 1 / Length(at);
        m.Add(at * inverse, areaTimesHeight * weight * inverse * inverse * inverse);
    };
    add(1.0 / 3, 1.0 / 3, 9.0 / 40);
    for (const auto &[b, weight] : {std::pair(kInner, kInnerWeight), std::pair(kOuter, kOuterWeight)}) {
        add(b, b, weight);
        add(1 - 2 * b, b, weight);
        add(b, 1 - 2 * b, weight);
    }
}

/// A corner relative to the receiver.
struct SeenCorner {
    Vec3d offset, direction; ///< from the receiver; the unit vector along it
    double length = 0;
    explicit SeenCorner(const Vec3d &w) : offset(w), direction(Normalize(w)), length(Length(w)) {}
};

/// Adds the contribution of the edge from a to b to the first and second moments. `cross` is the cross product of their
/// offsets.
///
/// With D the Laplacian of the sphere, D(w_i) = -2 w_i and D(w_i w_j) = 2 delta_ij - 6 w_i w_j, so the divergence
/// theorem turns both moments into integrals along the edges, which are arcs of great circles with a constant outward
/// normal; a third of the solid angle on the diagonal is all that remains.
inline void AddEdge(PolygonMoments &m, const SeenCorner &a, const SeenCorner &b, const Vec3d &cross) {
    const double sine = Length(cross), cosine = Dot(a.offset, b.offset);
    if (!(sine > 0)) // the edge is in line with the receiver
        return;
    const Vec3d outward = cross / -sine; // clockwise corners: the inside is to the right of each edge
    // Integral of w along the arc, in the form that avoids cancellation.
    const Vec3d arc = cosine > 0 ? (a.direction + b.direction) * (sine / (a.length * b.length + cosine))
                                 : Cross(outward, b.direction - a.direction);
    m.first -= outward * (FastAtan2(sine, cosine) * 0.5);
    m.xx -= arc.x * outward.x / 3, m.yy -= arc.y * outward.y / 3, m.zz -= arc.z * outward.z / 3;
    m.xy -= (arc.x * outward.y + arc.y * outward.x) / 6;
    m.yz -= (arc.y * outward.z + arc.z * outward.y) / 6;
    m.xz -= (arc.x * outward.z + arc.z * outward.x) / 6;
}

/// Moments by integrals along the edges, for a polygon that is not far away.
inline PolygonMoments MomentsByEdges(std::span<const Vec3f> corners, const Vec3d &p, const PolygonAspect &aspect) {
    PolygonMoments m;
    // Near the polygon, triangles from the foot of the perpendicular lose fewer digits; farther away, triangles that
    // fan out from the first corner. The arguments of the factors add up to half the solid angle, which is below pi.
    const bool fan = 4 * aspect.sizeSquared < aspect.distanceSquared;
    const SeenCorner first{Vec3d(corners[0]) - p};
    std::complex<double> half = 1;
    SeenCorner a{Vec3d(corners.back()) - p};
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const SeenCorner b{Vec3d(corners[i]) - p};
        const Vec3d edge = b.offset - a.offset, cross = Cross(a.offset, edge);
        AddEdge(m, a, b, cross);
        const double scale = 1 / (a.length * b.length);
        if (!fan)
            half *= scale * HalfSolidAngle(aspect.normal, 1, a.offset, a.length, b.offset, b.length, cross);
        else if (i >= 2)
            half *= scale / first.length *
                    HalfSolidAngle(first.offset, first.length, a.offset, a.length, b.offset, b.length,
                                   Cross(a.offset - first.offset, edge));
        a = b;
    }
    m.solidAngle = 2 * FastAtan2(half.imag(), half.real());
    if (m.solidAngle < -std::numbers::pi) // rounding at 2 pi
        m.solidAngle += 4 * std::numbers::pi;
    if (!(m.solidAngle > 0))
        return {};
    m.xx += m.solidAngle / 3, m.yy += m.solidAngle / 3, m.zz += m.solidAngle / 3;
    return m;
}

/// Moments of the polygon `corners` (convex, planar) as seen from `p`. Corners run clockwise as seen from the front;
/// from the back, from the polygon's own plane, or for a degenerate polygon everything is zero.
///
/// Every moment is right to 1e-14 times the distance of the farthest corner over that of the nearest edge. From farther
/// away than 64 times the polygon's size it is also right to 1e-10 of the solid angle, or, when that is seen at
/// grazing angle, to 1e-14 of the square of size over distance.
inline PolygonMoments MomentsOfPolygon(std::span<const Vec3f> corners, const Vec3d &p) {
    if (corners.size() < 3)
        return {};
    const PolygonAspect aspect(corners, p);
    constexpr double kFar = 64; // distance / size
    if (aspect.sizeSquared * kFar * kFar < aspect.distanceSquared) {
        PolygonMoments m;
        const Vec3d origin(corners[0]);
        for (std::size_t i = 2; i < corners.size(); ++i)
            AddFarTriangle(m, origin - p, Vec3d(corners[i - 1]) - origin, Vec3d(corners[i]) - origin);
        return m.solidAngle > 0 ? m : PolygonMoments{};
    }
    constexpr double kInPlane = 1e-14; // height / distance; anything less is rounding
    return aspect.height > kInPlane * std::sqrt(aspect.distanceSquared) ? MomentsByEdges(corners, p, aspect)
                                                                        : PolygonMoments{};
}

} // namespace q3
