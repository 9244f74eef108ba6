// GPL-2.0-or-later. Convex hulls in a plane.
#pragma once

#include "libs/math/winding.h"

#include <algorithm>

namespace q3 {

/// The convex hull of points in a plane, clockwise as seen from the tip of the unit normal, without corners that stick
/// out by less than `tolerance`. Empty when all points are that close to a line. Andrew's monotone chain.
inline Winding<double> ConvexHull(std::vector<Vec3d> points, const Vec3d &normal, double tolerance) {
    const Vec3d axis = std::abs(normal.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d right = Normalize(Cross(axis, normal)), up = Cross(normal, right);
    // Stable, as points that differ only along the normal compare equal.
    std::stable_sort(points.begin(), points.end(), [&](const Vec3d &a, const Vec3d &b) {
        const double ax = Dot(a, right), bx = Dot(b, right);
        return ax != bx ? ax < bx : Dot(a, up) < Dot(b, up);
    });
    Winding<double> hull;
    // Adds p to the hull and drops the corners that it makes superfluous; the first `kept` corners stay.
    const auto add = [&](const Vec3d &p, std::size_t kept) {
        while (hull.size() > kept) {
            const Vec3d &a = hull[hull.size() - 2], &b = hull.back();
            // Where p turns back, b is an extreme point however near to the line a p it is.
            const double least = Dot(p - b, b - a) > 0 ? tolerance * Length(p - a) : 0;
            if (Dot(Cross(p - b, b - a), normal) > least)
                break;
            hull.pop_back();
        }
        hull.push_back(p);
    };
    for (const Vec3d &p : points)
        add(p, 1);
    const std::size_t half = hull.size();
    for (auto p = points.rbegin(); p != points.rend(); ++p)
        add(*p, half);
    if (!hull.empty())
        hull.pop_back();
    if (hull.size() < 3)
        hull.clear();
    return hull;
}

} // namespace q3
