// GPL-2.0-or-later. Three points of a plane, as map text has them.
#include "q3map2/convert/source/plane_points.h"

#include "common/text/text.h"
#include "q3map2/convert/source/texture_form.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace q3 {

namespace {

/// Half a unit in the last place of normals stored as float.
constexpr double kNormalError = 3e-8;
constexpr double kDistanceError = 1e-5; ///< game units
constexpr double kApart = 256;          ///< game units

using ThreePoints = std::array<Vec3d, 3>;

/// Corners that span a large triangle.
ThreePoints SpreadCorners(std::span<const Vec3d> winding) {
    const Vec3d &first = winding.front();
    const auto farther = [&](const Vec3d &a, const Vec3d &b) { return Length(a - first) < Length(b - first); };
    const Vec3d &second = *std::ranges::max_element(winding, farther);
    const auto offLine = [&](const Vec3d &p) { return Length(Cross(p - first, second - first)); };
    const Vec3d &third = *std::ranges::max_element(winding, {}, offLine);
    return {first, second, third};
}

ThreePoints PointsApart(const Plane &plane, const Vec3d &near) {
    const Vec3d &n = plane.normal;
    const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    const Vec3d axis = x <= y && x <= z ? Vec3d{1, 0, 0} : y <= z ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1};
    const Vec3d u = Normalize(Cross(axis, n)), v = Cross(n, u);
    const Vec3d base = near - n * plane.Distance(near);
    return {base, base + u * kApart, base + v * kApart};
}

/// The points as text that reads as a plane with that front.
PlanePoints Printed(ThreePoints points, int decimals, const Vec3d &front) {
    PlanePoints printed;
    for (Vec3d &p : points)
        for (std::size_t axis = 0; axis < 3; ++axis)
            p[axis] = NumberFromText(FixedText(p[axis], decimals));
    printed.plane = PlaneThrough(points);
    if (Dot(printed.plane.normal, front) < 0) {
        std::swap(points[1], points[2]);
        printed.plane = PlaneThrough(points);
    }
    for (std::size_t i = 0; i < 3; ++i)
        printed.points[i] = fmt::format("( {} {} {} )", FixedText(points[i].x, decimals),
                                        FixedText(points[i].y, decimals), FixedText(points[i].z, decimals));
    return printed;
}

bool Agrees(const Plane &a, const Plane &b) {
    const double lastPlace = std::abs(b.dist) * double(std::numeric_limits<float>::epsilon()) / 2;
    const Vec3d off = a.normal - b.normal;
    return std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}) <= kNormalError &&
           std::abs(a.dist - b.dist) <= std::max(kDistanceError, lastPlace);
}

} // namespace

std::string PointText(const Vec3d &p) {
    return fmt::format("( {} {} {} )", ExactText(p.x), ExactText(p.y), ExactText(p.z));
}

Plane PlaneThrough(const ThreePoints &points) {
    const Vec3d normal = Normalize(Cross(points[2] - points[0], points[1] - points[0]));
    return {normal, Dot(normal, points[0])};
}

PlanePoints PointsOfPlane(const Plane &plane, std::span<const Vec3d> winding) {
    const double length = Length(plane.normal);
    const Plane wanted{plane.normal / length, plane.dist / length};
    if (winding.size() >= 3)
        for (const int decimals : {3, 6}) {
            const PlanePoints points = Printed(SpreadCorners(winding), decimals, wanted.normal);
            if (Agrees(points.plane, wanted))
                return points;
        }
    Vec3d center;
    for (const Vec3d &p : winding)
        center += p / double(winding.size());
    const ThreePoints apart = PointsApart(wanted, center);
    constexpr int kMostDecimals = 12;
    for (int decimals = 3; decimals < kMostDecimals; decimals += 3) {
        const PlanePoints points = Printed(apart, decimals, wanted.normal);
        if (Agrees(points.plane, wanted))
            return points;
    }
    return Printed(apart, kMostDecimals, wanted.normal);
}

} // namespace q3
