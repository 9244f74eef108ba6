// GPL-2.0-or-later. Order of triangles for the vertex cache.
#pragma once

#include <cstddef>
#include <vector>

namespace q3 {

/// Number of indexes of a triangle.
inline constexpr std::size_t kIndexesPerTriangle = 3;

/// Reorders triangles so that vertices are reused while they are in the vertex cache.
std::vector<int> OrderTriangles(const std::vector<int> &indexes);

} // namespace q3
