// GPL-2.0-or-later. Windings of the portal flow, without allocation, and the planes that separate two of them.
#pragma once

#include "libs/math/vec.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <span>

namespace q3 {

/// Points closer to a plane than this (game units) are on it. No float lies between 0.1f and 0.1, so comparing a float
/// with either gives the same.
inline constexpr float kOnEpsilon = 0.1f;
/// A clip that would give more points is skipped. The winding then stays too large, which is safe.
inline constexpr int kMaxCutPoints = 24;
/// Largest number of points of a portal: the reader of .prt files and MergePortals give no more.
inline constexpr int kMaxPortalPoints = 512;
/// Loops process points in groups of this size; arrays are padded to whole groups.
inline constexpr int kPointGroup = 4;

/// One coordinate of a group of points. GCC and clang both have this vector type.
using PointLanes = float __attribute__((vector_size(sizeof(float) * kPointGroup)));

inline PointLanes LoadLanes(const float *from) {
    PointLanes lanes;
    std::memcpy(&lanes, from, sizeof(lanes));
    return lanes;
}
inline void StoreLanes(const PointLanes &lanes, float *to) {
    std::memcpy(to, &lanes, sizeof(lanes));
}
inline PointLanes MinLanes(const PointLanes &a, const PointLanes &b) {
    return a < b ? a : b;
}
inline PointLanes MaxLanes(const PointLanes &a, const PointLanes &b) {
    return a > b ? a : b;
}
inline float MinLane(const PointLanes &lanes) {
    return std::min(std::min(lanes[0], lanes[1]), std::min(lanes[2], lanes[3]));
}
inline float MaxLane(const PointLanes &lanes) {
    return std::max(std::max(lanes[0], lanes[1]), std::max(lanes[2], lanes[3]));
}

/// The points p with normal . p = dist; those in front have more.
struct VisPlane {
    Vec3f normal;
    float dist = 0;
    float Distance(const Vec3f &p) const { return Dot(p, normal) - dist; }
    VisPlane Flipped() const { return {-normal, -dist}; }
};

/// The plane of three points; seen from the tip of its normal they run clockwise. False: they are collinear.
inline bool PlaneOfPoints(const Vec3f &a, const Vec3f &b, const Vec3f &c, VisPlane &plane) {
    const Vec3f normal = Cross(c - a, b - a);
    const double length = std::sqrt(double(normal.x) * double(normal.x) + double(normal.y) * double(normal.y) +
                                    double(normal.z) * double(normal.z));
    if (!(length > 0))
        return false;
    const double scale = 1 / length;
    plane.normal = {float(double(normal.x) * scale), float(double(normal.y) * scale), float(double(normal.z) * scale)};
    plane.dist = Dot(a, plane.normal);
    return true;
}

/// A view of points (x[i], y[i], z[i]) in arrays that it does not own. Padding repeats the first point.
struct WindingView {
    const float *x = nullptr, *y = nullptr, *z = nullptr;
    int count = 0;
    Vec3f Point(int i) const { return {x[i], y[i], z[i]}; }
    /// Dot products of the group of points from i on with a direction.
    PointLanes Project(const Vec3f &n, int i) const {
        return LoadLanes(x + i) * n.x + LoadLanes(y + i) * n.y + LoadLanes(z + i) * n.z;
    }
};

/// Storage for a clipped winding.
struct WindingBuffer {
    float x[kMaxCutPoints + kPointGroup], y[kMaxCutPoints + kPointGroup], z[kMaxCutPoints + kPointGroup];

    void Set(int i, const Vec3f &p) { x[i] = p.x, y[i] = p.y, z[i] = p.z; }
    WindingView View(int count) {
        for (int i = count; i % kPointGroup != 0; ++i)
            x[i] = x[0], y[i] = y[0], z[i] = z[0];
        return {x, y, z, count};
    }
};

/// Signed distances of all points from a plane, and their extrema.
struct PointDistances {
    float of[kMaxPortalPoints];
    float min, max;

    PointDistances(const WindingView &w, const VisPlane &plane) {
        PointLanes low = w.Project(plane.normal, 0) - plane.dist, high = low;
        StoreLanes(low, of);
        for (int i = kPointGroup; i < w.count; i += kPointGroup) {
            const PointLanes d = w.Project(plane.normal, i) - plane.dist;
            StoreLanes(d, of + i);
            low = MinLanes(d, low), high = MaxLanes(d, high);
        }
        min = MinLane(low), max = MaxLane(high);
    }
};

/// Intersection of the edge from a (distance da) to b (distance db) with the plane; exact on the axis of an axial
/// plane.
inline Vec3f CutEdge(const Vec3f &a, const Vec3f &b, float da, float db, const VisPlane &plane) {
    const float f = da / (da - db);
    Vec3f cut = a + (b - a) * f;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (plane.normal[axis] == 1)
            cut[axis] = plane.dist;
        else if (plane.normal[axis] == -1)
            cut[axis] = -plane.dist;
    }
    return cut;
}

/// Clips `w` to the front of the plane; if points change they are stored in `buffer`, which `w` must not view.
/// False: nothing is in front. A clip to more than kMaxCutPoints points is skipped.
inline bool ChopInFront(WindingView &w, const VisPlane &plane, WindingBuffer &buffer) {
    const PointDistances d(w, plane);
    if (!(d.min <= -kOnEpsilon))
        return true;
    if (!(d.max >= kOnEpsilon))
        return false;
    int count = 0;
    for (int i = 0; i < w.count; ++i) {
        const int next = i + 1 == w.count ? 0 : i + 1;
        const bool front = d.of[i] >= kOnEpsilon, back = d.of[i] <= -kOnEpsilon;
        const bool nextFront = d.of[next] >= kOnEpsilon, nextBack = d.of[next] <= -kOnEpsilon;
        if (count + 2 > kMaxCutPoints)
            return true;
        if (!back)
            buffer.Set(count++, w.Point(i));
        if ((front && nextBack) || (back && nextFront))
            buffer.Set(count++, CutEdge(w.Point(i), w.Point(next), d.of[i], d.of[next], plane));
    }
    w = buffer.View(count);
    return true;
}

/// Which of two windings is in front of a plane that separates them.
enum class InFront { S, T };

/// The plane through an edge of `s` (points `edge` and `edge` + 1) and a point of `t` that separates the two windings.
/// False: no point of `t` gives such a plane.
inline bool SeparatorOfEdge(const WindingView &s, const WindingView &t, int edge, InFront inFront, VisPlane &plane) {
    const int after = edge + 1 == s.count ? 0 : edge + 1;
    const Vec3f a = s.Point(edge), b = s.Point(after);
    for (int j = 0; j < t.count; ++j) {
        if (!PlaneOfPoints(a, t.Point(j), b, plane))
            continue;
        // Turns `s` behind the plane, by the first of its points that is not on it; none if the plane is that of `s`.
        int k = 0;
        float side = 0;
        for (; k < s.count; ++k)
            if (k != edge && k != after && std::abs(side = plane.Distance(s.Point(k))) >= kOnEpsilon)
                break;
        if (k == s.count)
            continue;
        if (side > 0)
            plane = plane.Flipped();
        // All of `t` must be in front of it or on it.
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
        if (inFront == InFront::S)
            plane = plane.Flipped();
        return true;
    }
    return false;
}

/// Side of a winding's plane: that of the tip of its normal, or the opposite one.
enum class NormalSide { Front, Behind };

/// The planes of SeparatorOfEdge for all edges of `s`, found in one pass over the points of `t` per edge. `normal` is
/// the unit normal of `s`; seen from its tip the points of `s` run counterclockwise. `side`: where `t` lies. All planes
/// have `s` behind them. Writes as many as fit into `planes` and returns their number.
int TangentPlanes(const WindingView &s, const Vec3f &normal, const WindingView &t, NormalSide side,
                  std::span<VisPlane> planes);

} // namespace q3
