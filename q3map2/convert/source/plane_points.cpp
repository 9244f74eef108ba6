// GPL-2.0-or-later. Finds three points that define a plane in map text.
#include "q3map2/convert/source/plane_points.h"

#include "common/text/text.h"
#include "q3map2/convert/source/texture_form.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace q3 {

namespace {

constexpr double kSameDistance = 1e-7; ///< difference of equal plane distances, game units
constexpr double kSpacing = 256;       ///< between points that are not corners, game units

using ThreePoints = std::array<Vec3d, 3>;

/// Corners that span a large triangle.
ThreePoints SpreadCorners(std::span<const Vec3d> winding) {
    const Vec3d &first = winding.front();
    const auto nearer = [&](const Vec3d &a, const Vec3d &b) { return Length(a - first) < Length(b - first); };
    const Vec3d &second = *std::ranges::max_element(winding, nearer);
    const auto offLine = [&](const Vec3d &p) { return Length(Cross(p - first, second - first)); };
    const Vec3d &third = *std::ranges::max_element(winding, {}, offLine);
    return {first, second, third};
}

/// The projection of `near` onto the plane, and two points of the plane kSpacing from it.
ThreePoints PointsApart(const Plane &plane, const Vec3d &near) {
    const Vec3d &n = plane.normal;
    const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    const Vec3d axis = x <= y && x <= z ? Vec3d{1, 0, 0} : y <= z ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1};
    const Vec3d u = Normalize(Cross(axis, n)), v = Cross(n, u);
    const Vec3d base = near - n * plane.Distance(near);
    return {base, base + u * kSpacing, base + v * kSpacing};
}

/// The points rounded to `decimals`, in the order that makes the plane face along `front`.
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

/// Half the spacing of floats from `value` upward if it is a power of two; otherwise up to twice that.
double HalfStep(double value) {
    return std::abs(value) * double(std::numeric_limits<float>::epsilon()) / 2;
}

/// A unit vector that rounds to `normal`, whose length differs from 1 as its components were rounded to float. If there
/// is none, the normalized normal.
Vec3d UnitStoredAs(const Vec3d &normal) {
    Vec3d slack;
    double reach = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (normal[axis] == 0)
            continue;
        // All floats of a binade are equally far apart; below its first one they are twice as dense.
        const double first = std::exp2(std::floor(std::log2(std::abs(normal[axis]))));
        const bool isFirst = std::abs(normal[axis]) == first;
        slack[axis] = std::copysign(HalfStep(first) * (isFirst ? 0.5 : 1), normal[axis]);
        reach += std::abs(slack[axis] * normal[axis]);
    }
    const double excess = (Dot(normal, normal) - 1) / 2;
    const Vec3d moved = normal - slack * (excess / reach);
    return std::abs(excess) <= reach ? Normalize(moved) : Normalize(normal);
}

/// Whether the planes are the same once they are stored as float.
bool Agrees(const Plane &a, const Plane &b) {
    return Vec3f(a.normal) == Vec3f(b.normal) &&
           std::abs(a.dist - b.dist) <= std::max(kSameDistance, HalfStep(b.dist) / 2);
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
    const Plane wanted{UnitStoredAs(Vec3d(Vec3f(plane.normal))), plane.dist};
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
