// GPL-2.0-or-later. Windings of the portal flow, without allocation, and the planes that separate two of them.
#include "q3map2/vis/vis_winding.h"

namespace q3 {

namespace {

// Project everything along an edge of `s` to 2D: v is the distance from the plane of `s`, positive on the side of `t`,
// and u the distance from the edge, positive towards the inside of `s`. There `s` is the segment v = 0, u > 0 and the
// edge the origin. Planes through the edge are lines through the origin; the one that has all of `t` on one side and
// touches it passes through the point of `t` with the greatest slope u / v.

constexpr float kNoSlope = -1e30f;  ///< below any slope
constexpr float kMinHeight = 1e-3f; ///< game units; v of points in the plane of `s` is raised to it

/// An edge of `s`: u of a point p is Dot(inward, p) - origin: its distance from the edge times |inward|.
struct InwardEdge {
    Vec3f inward;
    float origin, squaredLength; ///< `squaredLength` is that of `inward`

    InwardEdge(const WindingView &s, const Vec3f &normal, int edge) {
        const Vec3f a = s.Point(edge), b = s.Point(edge + 1 == s.count ? 0 : edge + 1);
        inward = Cross(normal, b - a);
        origin = Dot(inward, a);
        squaredLength = Dot(inward, inward);
    }
    /// The greatest slope u / v of the points of `t`, given their v; stores their u. Points on the edge do not count.
    float MaxSlope(const WindingView &t, const float *v, float *u) const {
        const float squaredNear = kOnEpsilon * kOnEpsilon * squaredLength;
        const PointLanes none = {kNoSlope, kNoSlope, kNoSlope, kNoSlope};
        const PointLanes lowest = {kMinHeight, kMinHeight, kMinHeight, kMinHeight};
        PointLanes slope = none;
        for (int i = 0; i < t.count; i += kPointGroup) {
            const PointLanes across = t.Project(inward, i) - origin, height = LoadLanes(v + i);
            StoreLanes(across, u + i);
            const PointLanes ratio = across / MaxLanes(height, lowest);
            slope = MaxLanes(across * across + height * height * squaredLength < squaredNear ? none : ratio, slope);
        }
        return MaxLane(slope);
    }
    /// The greatest u of the points of `s`.
    float Depth(const WindingView &s) const {
        PointLanes deepest = s.Project(inward, 0);
        for (int i = kPointGroup; i < s.count; i += kPointGroup)
            deepest = MaxLanes(s.Project(inward, i), deepest);
        return MaxLane(deepest) - origin;
    }
};

/// Whether no point (u, v) is behind the plane of a slope and at least one is in front; `epsilon` in units of u.
bool IsInFront(const float *u, const float *v, int count, float slope, float epsilon) {
    PointLanes low = LoadLanes(v) * slope - LoadLanes(u), high = low;
    for (int i = kPointGroup; i < count; i += kPointGroup) {
        const PointLanes d = LoadLanes(v + i) * slope - LoadLanes(u + i);
        low = MinLanes(d, low), high = MaxLanes(d, high);
    }
    return MinLane(low) > -epsilon && MaxLane(high) >= epsilon;
}

} // namespace

int TangentPlanes(const WindingView &s, const Vec3f &normal, const WindingView &t, NormalSide side,
                  std::span<VisPlane> planes) {
    const Vec3f up = side == NormalSide::Behind ? -normal : normal;
    const float offset = Dot(up, s.Point(0));
    float u[kMaxPortalPoints], v[kMaxPortalPoints];
    for (int i = 0; i < t.count; i += kPointGroup)
        StoreLanes(t.Project(up, i) - offset, v + i);
    int count = 0;
    for (int edge = 0; edge < s.count && count < int(planes.size()); ++edge) {
        const InwardEdge along(s, normal, edge);
        const float slope = along.MaxSlope(t, v, u);
        if (slope == kNoSlope)
            continue;
        const float length = std::sqrt(slope * slope + along.squaredLength), epsilon = kOnEpsilon * length;
        if (along.Depth(s) < epsilon || !IsInFront(u, v, t.count, slope, epsilon))
            continue;
        VisPlane &plane = planes[std::size_t(count++)];
        plane.normal = (up * slope - along.inward) * (1 / length);
        plane.dist = Dot(plane.normal, s.Point(edge));
    }
    return count;
}

} // namespace q3
