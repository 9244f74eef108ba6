// GPL-2.0-or-later. Which leafs brushes are in.
#pragma once

#include "q3map2/map/map.h"
#include "q3map2/tree/tree.h"

namespace q3 {

/// Adds the structural brushes to the leafs that they reach. Opaque brushes make their leafs opaque, area portals mark
/// the portals inside them.
void FilterStructuralBrushes(const MapEntity &entity, Tree &tree, PlaneTable &planes, const BspContext &context);
/// Adds the detail brushes to the leafs that they reach.
void FilterDetailBrushes(const MapEntity &entity, Tree &tree, PlaneTable &planes, const BspContext &context);

} // namespace q3
