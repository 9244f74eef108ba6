// GPL-2.0-or-later. Order of triangles for the vertex cache.
#pragma once

#include <vector>

namespace q3 {

/// The triangles reordered so that vertices are used again soon.
std::vector<int> OrderTriangles(const std::vector<int> &indexes);

} // namespace q3
