// GPL-2.0-or-later. Visible hulls of brush sides.
#pragma once

#include "q3map2/map/map.h"
#include "q3map2/tree/tree.h"

namespace q3 {

/// Sets the visible hull of each side: the convex hull of its parts in open leafs.
void ClipSidesIntoTree(MapEntity &entity, const Tree &tree, const PlaneTable &planes, const BspContext &context);

} // namespace q3
