// GPL-2.0-or-later. Triangles of a mesh merged to convex polygons.
#pragma once

#include "libs/math/winding_clip.h"

#include <array>
#include <span>
#include <vector>

namespace q3 {

/// Clockwise polygons. Coplanar neighbors are merged while the result is convex; degenerate triangles are
/// ignored.
std::vector<Polygon> MergedTriangles(std::span<const Vec3f> points, std::span<const std::array<int, 3>> triangles);

} // namespace q3
