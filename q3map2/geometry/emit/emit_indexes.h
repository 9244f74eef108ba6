// GPL-2.0-or-later. Order of triangles for the vertex cache.
#pragma once

#include <cstddef>
#include <vector>

namespace q3 {

/// Indexes of a triangle.
inline constexpr std::size_t kTriangle = 3;

/// The triangles reordered so that vertices are used again soon.
std::vector<int> OrderTriangles(const std::vector<int> &indexes);

} // namespace q3
