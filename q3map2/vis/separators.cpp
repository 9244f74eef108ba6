// GPL-2.0-or-later. Planes between two windings.
#include "q3map2/vis/separators.h"

namespace q3 {

namespace {

// Seen along an edge of `s`, everything is two numbers: v, how far it is from the plane of `s` on the side of `t`, and
// u, how far to the inside of the edge. `s` lies where v = 0 and u > 0, so the plane that touches `t` goes through its
// point of the greatest slope u / v.

constexpr float kNoSlope = -1e30f;
constexpr float kLeastHeight = 1e-3f; ///< units; for slopes of points in the plane of `s`

/// An edge of `s`: u is `inward` * p - origin, in units of the length of `inward`.
struct InwardEdge {
    Vec3f inward;
    float origin, square; ///< `square` is that of the length of `inward`

    InwardEdge(const WindingView &s, const Vec3f &normal, int edge) {
        const Vec3f a = s.Point(edge), b = s.Point(edge + 1 == s.count ? 0 : edge + 1);
        inward = Cross(normal, b - a);
        origin = Dot(inward, a);
        square = Dot(inward, inward);
    }
    /// The greatest slope of points of `t` with heights v; those on the edge have none. Keeps their u.
    float GreatestSlope(const WindingView &t, const float *v, float *u) const {
        const float near = kOnEpsilon * kOnEpsilon * square;
        const PointLanes none = {kNoSlope, kNoSlope, kNoSlope, kNoSlope};
        const PointLanes lowest = {kLeastHeight, kLeastHeight, kLeastHeight, kLeastHeight};
        PointLanes slope = none;
        for (int i = 0; i < t.count; i += kPointGroup) {
            const PointLanes across = t.Along(inward, i) - origin, height = LoadLanes(v + i);
            StoreLanes(across, u + i);
            const PointLanes ratio = across / GreaterLanes(height, lowest);
            slope = GreaterLanes(across * across + height * height * square < near ? none : ratio, slope);
        }
        return GreatestLane(slope);
    }
    /// The greatest u of the points of `s`.
    float Depth(const WindingView &s) const {
        PointLanes deepest = s.Along(inward, 0);
        for (int i = kPointGroup; i < s.count; i += kPointGroup)
            deepest = GreaterLanes(s.Along(inward, i), deepest);
        return GreatestLane(deepest) - origin;
    }
};

/// Whether no point is behind the plane of a slope and one is in front; `epsilon` in units of `u`.
bool IsInFront(const float *u, const float *v, int count, float slope, float epsilon) {
    PointLanes low = LoadLanes(v) * slope - LoadLanes(u), high = low;
    for (int i = kPointGroup; i < count; i += kPointGroup) {
        const PointLanes d = LoadLanes(v + i) * slope - LoadLanes(u + i);
        low = LesserLanes(d, low), high = GreaterLanes(d, high);
    }
    return LeastLane(low) > -epsilon && GreatestLane(high) >= epsilon;
}

} // namespace

int TangentPlanes(const WindingView &s, const Vec3f &normal, const WindingView &t, bool behind,
                  std::span<VisPlane> planes) {
    const Vec3f up = behind ? -normal : normal;
    const float base = Dot(up, s.Point(0));
    float u[kMaxPortalPoints], v[kMaxPortalPoints];
    for (int i = 0; i < t.count; i += kPointGroup)
        StoreLanes(t.Along(up, i) - base, v + i);
    int count = 0;
    for (int edge = 0; edge < s.count && count < int(planes.size()); ++edge) {
        const InwardEdge along(s, normal, edge);
        const float slope = along.GreatestSlope(t, v, u);
        if (slope == kNoSlope)
            continue;
        const float length = std::sqrt(slope * slope + along.square), epsilon = kOnEpsilon * length;
        if (along.Depth(s) < epsilon || !IsInFront(u, v, t.count, slope, epsilon))
            continue;
        VisPlane &plane = planes[std::size_t(count++)];
        plane.normal = (up * slope - along.inward) * (1 / length);
        plane.dist = Dot(plane.normal, s.Point(edge));
    }
    return count;
}

} // namespace q3
