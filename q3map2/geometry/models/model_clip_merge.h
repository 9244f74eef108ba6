// GPL-2.0-or-later. Triangles of a mesh joined to convex polygons.
#pragma once

#include "libs/math/winding_clip.h"

#include <array>
#include <span>
#include <vector>

namespace q3 {

/// Clockwise polygons. Neighbours in one plane are joined while the result is convex; triangles without area are left
/// out.
std::vector<Polygon> MergedTriangles(std::span<const Vec3f> points, std::span<const std::array<int, 3>> triangles);

} // namespace q3
