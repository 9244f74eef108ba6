// GPL-2.0-or-later. Brush sides that are drawn in several parts.
#pragma once

#include "q3map2/map/map.h"

#include <unordered_map>
#include <vector>

namespace q3 {

/// By side: the convex parts that are drawn instead of its visible hull. Sides that are not listed are in one part.
using SideParts = std::unordered_map<const BrushSide *, std::vector<Polygon>>;

} // namespace q3
