// GPL-2.0-or-later. Windings of the portal flow: no allocation, points as three runs of numbers.
#pragma once

#include "libs/math/vec.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace q3 {

/// Points within it count as on a plane. Game units. Comparisons of floats against it equal those against 0.1 itself.
inline constexpr float kOnEpsilon = 0.1f;
/// A cut that would give more points is not made.
inline constexpr int kMaxCutPoints = 24;
/// Points of the largest portal.
inline constexpr int kMaxPortalPoints = 512;
/// Runs are padded to whole groups, so that loops take a group at once.
inline constexpr int kPointGroup = 4;

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
        const float nx = plane.normal.x, ny = plane.normal.y, nz = plane.normal.z, dist = plane.dist;
        float low[kPointGroup], high[kPointGroup];
        for (int k = 0; k < kPointGroup; ++k)
            low[k] = high[k] = of[k] = w.x[k] * nx + w.y[k] * ny + w.z[k] * nz - dist;
        for (int i = kPointGroup; i < w.count; i += kPointGroup)
            for (int k = 0; k < kPointGroup; ++k) {
                const float d = w.x[i + k] * nx + w.y[i + k] * ny + w.z[i + k] * nz - dist;
                of[i + k] = d;
                low[k] = d < low[k] ? d : low[k];
                high[k] = d > high[k] ? d : high[k];
            }
        least = std::min(std::min(low[0], low[1]), std::min(low[2], low[3]));
        greatest = std::max(std::max(high[0], high[1]), std::max(high[2], high[3]));
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

/// The plane through an edge of `s` (its point `edge` and the next) and a point of `t` that has `s` on its back and `t`
/// in front; sides exchanged if `flip`. False: there is none.
inline bool SeparatorOfEdge(const WindingView &s, const WindingView &t, int edge, bool flip, VisPlane &plane) {
    const int after = edge + 1 == s.count ? 0 : edge + 1;
    const Vec3f a = s.Point(edge), b = s.Point(after);
    for (int j = 0; j < t.count; ++j) {
        if (!PlaneOfPoints(a, t.Point(j), b, plane))
            continue;
        int k = 0;
        float side = 0;
        for (; k < s.count; ++k)
            if (k != edge && k != after && std::abs(side = plane.Distance(s.Point(k))) >= kOnEpsilon)
                break;
        if (k == s.count)
            continue;
        if (side > 0)
            plane = plane.Flipped();
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
        if (flip)
            plane = plane.Flipped();
        return true;
    }
    return false;
}

} // namespace q3
