// GPL-2.0-or-later. Cluster and area numbers of leafs.
#pragma once

#include "q3map2/map/map.h"
#include "q3map2/tree/tree.h"

#include <vector>

namespace q3 {

/// Numbers the clusters and returns their count. `deep`: leafs below a detail split share a cluster. Throws Error for
/// more clusters than a .bsp may have.
int NumberClusters(Tree &tree, bool deep);
/// Numbers the areas, the regions between area portals, and returns their count.
int FloodAreas(Tree &tree);
/// The area portals of the world that have the same area on both sides or lie in a solid, as indexes of its brushes.
/// Call it after FloodAreas.
std::vector<int> IdleAreaPortals(const Tree &tree, const MapEntity &world);

} // namespace q3
