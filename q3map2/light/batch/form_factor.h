// GPL-2.0-or-later. Form factors of polygons, and directions in rings over a hemisphere.
#pragma once

#include "libs/math/lane_functions.h"
#include "libs/math/vec.h"
#include "q3map2/light/batch/lanes.h"

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

namespace q3 {

/// Bound of the sum of the edge terms: at most 2 pi in exact arithmetic. A larger sum is rounding error near a
/// degenerate polygon; the form factor is then 0.
inline constexpr float kMaxEdgeSum = 6.3f;

/// An edge's term of Lambert's formula for the form factor: the angle between the directions u and v to its ends, times
/// n . (u x v) / |u x v|. sine = |u x v|, cosine = u . v, along = n . (u x v); u and v need not have unit length.
template <typename T> T EdgeTerm(T sine, T cosine, T along) {
    return sine > 0 ? AngleOf(sine, cosine) * along / sine : T(0);
}
template <typename T> T EdgeTerm(const Vec3<T> &u, const Vec3<T> &v, const Vec3<T> &n) {
    const Vec3<T> across = Cross(u, v);
    return EdgeTerm(Length(across), Dot(u, v), Dot(n, across));
}

/// Cosine-weighted fraction of the hemisphere around n that the polygon covers as seen from p, -1 to 1; positive in
/// front of a clockwise polygon. Not clipped to the horizon: parts behind the receiver count negatively. Lambert's
/// formula: the sum of the edges' terms over 2 pi.
template <typename T> T FormFactor(const Vec3<T> &p, const Vec3<T> &n, std::span<const Vec3f> polygon) {
    T total = 0;
    Vec3<T> u = polygon.empty() ? p : Vec3<T>(polygon.back()) - p;
    for (const Vec3f &corner : polygon) {
        const Vec3<T> v = Vec3<T>(corner) - p;
        total += EdgeTerm(u, v, n);
        u = v;
    }
    return std::abs(total) > T(kMaxEdgeSum) ? T(0) : total / (2 * std::numbers::pi_v<T>);
}

/// FormFactor of sixteen receivers in single precision: absolute error about 1e-6.
void FormFactors(const Lanes3 &p, const Lanes3 &n, std::span<const Vec3f> polygon, Lanes &formFactors);

/// The vectors v with FormFactor(p, n, polygon) = v . n for every n: the irradiance vectors of a polygon of radiance
/// 1 / pi, for sixteen receivers.
void FormFactorVectors(const Lanes3 &p, std::span<const Vec3f> polygon, Lanes3 &v);

/// The same for the parts of the polygon above the horizons of receivers with the normals n.
void FormFactorVectorsAbove(const Lanes3 &p, const Lanes3 &n, std::span<const Vec3f> polygon, Lanes3 &v);

/// Directions per ring for floodlight and dirt, and number of rings for floodlight.
inline constexpr int kRingAzimuths = 16, kFloodElevations = 4;
/// Half angle of the cone that floodlight and dirt rays fill. Degrees.
inline constexpr int kConeDegrees = 88;

/// Unit directions around +z in rings: ring e is (e + 1/2) floor(kConeDegrees / elevations) degrees from the axis, with
/// `azimuths` even steps that start at +x. Components below rounding error are set to 0, so that rays in the plane of a
/// wall stay in it.
std::vector<Vec3f> HemisphereRings(int elevations, int azimuths);

} // namespace q3
