// GPL-2.0-or-later. Faces that split the tree.
#pragma once

#include "q3map2/map/map.h"
#include "q3map2/tree/tree.h"

#include <vector>

namespace q3 {

/// Faces of the structural brushes' windings, for the first tree. Brushes with fewer than four sides become detail.
std::vector<TreeFace> StructuralFaces(MapEntity &world, const BspContext &context);
/// Faces of the visible hulls, for the second tree.
std::vector<TreeFace> VisibleFaces(const MapEntity &world, const BspContext &context);

} // namespace q3
