// GPL-2.0-or-later. Moments of polygons by adaptive quadrature, and random polygons, for tests of the closed form.
#pragma once

#include "libs/sh/polygon_moments.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace q3::test {

/// Solid angle, three first moments, six second ones: 1; x, y, z; xx, yy, zz, xy, yz, xz.
using Moments10 = std::array<long double, 10>;

/// Nodes and weights of Gauss-Legendre quadrature on [0, 1]: roots by Newton's method.
struct GaussRule {
    static constexpr int kNodes = 12;
    std::array<long double, kNodes> node{}, weight{};
    GaussRule();
};

/// Integrals over the polygon's fan of triangles, each with the sign of the side that it shows, as seen from p. Small
/// far triangles by Gauss quadrature over their area; others in polar coordinates around the foot of p in their plane,
/// radially in closed form, along edges by Gauss quadrature of pieces that are small against their distance.
Moments10 ReferenceMoments(std::span<const Vec3f> corners, const Vec3d &p, const GaussRule &gauss);
Moments10 ToArray(const PolygonMoments &m);

/// How a random polygon is seen.
enum class PolygonView {
    Anywhere, ///< any distance, any direction
    Grazing,  ///< from 1e-6 to 1 of its distance over its plane
    NearEdge,
    NearCorner,
    OverInside,    ///< over a point of it, from 1e-6 to 1 of its size
    FarFromOrigin, ///< at coordinates of 65536
    Count
};

struct PolygonCase {
    PolygonView view = PolygonView::Anywhere;
    std::vector<Vec3f> corners; ///< 3 to 8, clockwise seen from p
    Vec3d p;
};

/// Polygon number `index`: convex, sizes 1e-3 to 1e4, width over length down to 1e-6, distances 1e-3 to 1e5.
PolygonCase RandomPolygon(std::uint64_t index);

} // namespace q3::test
