// GPL-2.0-or-later. Faces that split the tree.
#pragma once

#include "q3map2/map/map.h"
#include "q3map2/tree/tree.h"

#include <vector>

namespace q3 {

/// Whole sides of structural brushes (and of detail brushes with -deep), for the first tree. Structural brushes with
/// fewer than four sides become detail.
std::vector<TreeFace> StructuralFaces(MapEntity &world, const BspContext &context);
/// Visible hulls of the same sides, for the second tree.
std::vector<TreeFace> VisibleFaces(const MapEntity &world, const BspContext &context);

} // namespace q3
