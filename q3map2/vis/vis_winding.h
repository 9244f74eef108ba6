// GPL-2.0-or-later. Windings of the portal flow: no allocation, points as three runs of numbers.
#pragma once

#include "libs/math/vec.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

namespace q3 {

/// Points within it count as on a plane. Game units. Comparisons of floats against it equal those against 0.1 itself.
inline constexpr float kOnEpsilon = 0.1f;
/// A cut that would give more points is not made.
inline constexpr int kMaxCutPoints = 24;
/// Points of the largest portal.
inline constexpr int kMaxPortalPoints = 512;
/// Runs are padded to whole groups, so that loops take a group at once.
inline constexpr int kPointGroup = 4;

/// A group of points on one axis, worked on at once.
using PointLanes = float __attribute__((vector_size(sizeof(float) * kPointGroup)));

inline PointLanes LoadLanes(const float *from) {
    PointLanes lanes;
    std::memcpy(&lanes, from, sizeof(lanes));
    return lanes;
}
inline void StoreLanes(const PointLanes &lanes, float *to) {
    std::memcpy(to, &lanes, sizeof(lanes));
}
inline PointLanes LesserLanes(const PointLanes &a, const PointLanes &b) {
    return a < b ? a : b;
}
inline PointLanes GreaterLanes(const PointLanes &a, const PointLanes &b) {
    return a > b ? a : b;
}
inline float LeastLane(const PointLanes &lanes) {
    return std::min(std::min(lanes[0], lanes[1]), std::min(lanes[2], lanes[3]));
}
inline float GreatestLane(const PointLanes &lanes) {
    return std::max(std::max(lanes[0], lanes[1]), std::max(lanes[2], lanes[3]));
}

struct VisPlane {
    Vec3f normal;
    float dist = 0;
    float Distance(const Vec3f &p) const { return Dot(p, normal) - dist; }
    VisPlane Flipped() const { return {-normal, -dist}; }
};

/// The plane of three points, clockwise for who its normal points at. False: they are on a line.
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

/// Points that lie somewhere else: x[i], y[i], z[i]. Padding repeats the first point.
struct WindingView {
    const float *x = nullptr, *y = nullptr, *z = nullptr;
    int count = 0;
    Vec3f Point(int i) const { return {x[i], y[i], z[i]}; }
    /// How far the points from i on, a group of them, are along a direction.
    PointLanes Along(const Vec3f &n, int i) const {
        return LoadLanes(x + i) * n.x + LoadLanes(y + i) * n.y + LoadLanes(z + i) * n.z;
    }
};

/// Where the result of a cut is put.
struct WindingBuffer {
    float x[kMaxCutPoints + kPointGroup], y[kMaxCutPoints + kPointGroup], z[kMaxCutPoints + kPointGroup];

    void Set(int i, const Vec3f &p) { x[i] = p.x, y[i] = p.y, z[i] = p.z; }
    WindingView View(int count) {
        for (int i = count; i % kPointGroup != 0; ++i)
            x[i] = x[0], y[i] = y[0], z[i] = z[0];
        return {x, y, z, count};
    }
};

/// Distances of all points, padding included; the least and the greatest.
struct PointDistances {
    float of[kMaxPortalPoints];
    float least, greatest;

    PointDistances(const WindingView &w, const VisPlane &plane) {
        PointLanes low = w.Along(plane.normal, 0) - plane.dist, high = low;
        StoreLanes(low, of);
        for (int i = kPointGroup; i < w.count; i += kPointGroup) {
            const PointLanes d = w.Along(plane.normal, i) - plane.dist;
            StoreLanes(d, of + i);
            low = LesserLanes(d, low), high = GreaterLanes(d, high);
        }
        least = LeastLane(low), greatest = GreatestLane(high);
    }
};

/// Where the edge from a (distance da) to b (db) meets the plane; exact on the axis of an axial plane.
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

/// Makes `w` its part in front of the plane, in `buffer` if it had to be cut. False: nothing is in front. A cut of more
/// than kMaxCutPoints is left out. `buffer` must not be what `w` refers to.
inline bool ChopInFront(WindingView &w, const VisPlane &plane, WindingBuffer &buffer) {
    const PointDistances d(w, plane);
    if (!(d.least <= -kOnEpsilon))
        return true;
    if (!(d.greatest >= kOnEpsilon))
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

} // namespace q3
