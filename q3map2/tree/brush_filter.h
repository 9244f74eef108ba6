// GPL-2.0-or-later. Adds brushes to the leafs that they reach.
#pragma once

#include "q3map2/map/map.h"
#include "q3map2/tree/tree.h"

namespace q3 {

/// Adds the structural brushes to the leafs that they reach. Opaque brushes make their leafs opaque, sides of area
/// portals mark the portals in them.
void FilterStructuralBrushes(const MapEntity &entity, Tree &tree, PlaneTable &planes, const BspContext &context);
/// Adds the detail brushes to the leafs that they reach.
void FilterDetailBrushes(const MapEntity &entity, Tree &tree, PlaneTable &planes, const BspContext &context);

} // namespace q3
