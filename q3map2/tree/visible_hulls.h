// GPL-2.0-or-later. Visible hulls of brush sides.
#pragma once

#include "q3map2/map/side_parts.h"
#include "q3map2/tree/tree.h"

#include <vector>

namespace q3 {

/// The convex hull of polygons in one plane, clockwise seen from the tip of its normal.
Polygon ConvexHull(std::vector<Polygon> pieces, const Vec3d &normal);

/// Sets the visible hull of each side: the convex hull of its parts in open leafs. Returns the sides that walls divide,
/// with their parts. Call it after CullSides.
SideParts ClipSidesIntoTree(MapEntity &entity, const Tree &tree, const PlaneTable &planes, const BspContext &context);

} // namespace q3
