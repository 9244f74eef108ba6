// GPL-2.0-or-later. Convex planar polygons.
#pragma once

#include "libs/math/bounds.h"
#include "libs/math/vec.h"

#include <cmath>
#include <vector>

namespace q3 {

template <typename T> using Winding = std::vector<Vec3<T>>;

struct Plane {
    Vec3d normal;
    double dist = 0;
    double Distance(const Vec3d &p) const { return Dot(normal, p) - dist; }
};

/// The square of half edge `halfSize` in the plane, centred at the point of the plane nearest to the origin.
inline Winding<double> WindingInPlane(const Plane &plane, double halfSize) {
    const Vec3d &n = plane.normal;
    const double ax = std::abs(n.x), ay = std::abs(n.y), az = std::abs(n.z);
    const Vec3d axis = az >= ax && az >= ay ? Vec3d{1, 0, 0} : Vec3d{0, 0, 1};
    const Vec3d right = Normalize(axis - n * Dot(axis, n)) * halfSize;
    const Vec3d up = Cross(n, right);
    const Vec3d center = n * plane.dist;
    return {center - right + up, center + right + up, center + right - up, center - right - up};
}

/// Cuts `w` by the plane normal . p = dist. Points within epsilon count as on the plane and go to both sides; a side
/// that has no point beyond epsilon is empty. A winding within the plane goes to the front.
template <typename T>
void SplitWinding(const Winding<T> &w, const Vec3<T> &normal, T dist, T epsilon, Winding<T> &front, Winding<T> &back) {
    front.clear(), back.clear();
    bool anyFront = false, anyBack = false;
    for (const Vec3<T> &p : w) {
        const T d = Dot(normal, p) - dist;
        anyFront |= d > epsilon, anyBack |= d < -epsilon;
    }
    if (!anyBack || !anyFront) {
        (anyBack ? back : front) = w;
        return;
    }
    for (std::size_t i = 0; i < w.size(); ++i) {
        const Vec3<T> &a = w[i], &b = w[(i + 1) % w.size()];
        const T da = Dot(normal, a) - dist, db = Dot(normal, b) - dist;
        if (da >= -epsilon)
            front.push_back(a);
        if (da <= epsilon)
            back.push_back(a);
        if ((da > epsilon && db < -epsilon) || (da < -epsilon && db > epsilon)) {
            const Vec3<T> cut = a + (b - a) * (da / (da - db));
            front.push_back(cut), back.push_back(cut);
        }
    }
    if (front.size() < 3)
        front.clear();
    if (back.size() < 3)
        back.clear();
}

/// Cuts corners, each with a place `xyz`, by the plane at `dist` across an axis. Those within epsilon go to both sides.
/// lerp(a, b, t) makes new ones. `front` and `back` are empty before.
template <typename Corner, typename Lerp>
void CutAcrossAxis(const std::vector<Corner> &corners, std::size_t axis, float dist, float epsilon, const Lerp &lerp,
                   std::vector<Corner> &front, std::vector<Corner> &back) {
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Corner &a = corners[i], &b = corners[(i + 1) % corners.size()];
        const float da = a.xyz[axis] - dist, db = b.xyz[axis] - dist;
        if (da >= -epsilon)
            front.push_back(a);
        if (da <= epsilon)
            back.push_back(a);
        if ((da > epsilon && db < -epsilon) || (da < -epsilon && db > epsilon)) {
            const Corner cut = lerp(a, b, da / (da - db));
            front.push_back(cut), back.push_back(cut);
        }
    }
}

/// Half the cross product sum: its length is the area.
template <typename T> Vec3d WindingAreaVector(const Winding<T> &w) {
    Vec3d sum;
    for (std::size_t i = 2; i < w.size(); ++i)
        sum += Cross(Vec3d(w[i - 1] - w[0]), Vec3d(w[i] - w[0]));
    return sum * 0.5;
}
template <typename T> double WindingArea(const Winding<T> &w) {
    return Length(WindingAreaVector(w));
}
template <typename T> Bounds<T> WindingBounds(const Winding<T> &w) {
    Bounds<T> bounds;
    for (const Vec3<T> &p : w)
        bounds.Add(p);
    return bounds;
}

} // namespace q3
