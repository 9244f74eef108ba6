// GPL-2.0-or-later. Cluster and area numbers of leafs.
#pragma once

#include "q3map2/tree/tree.h"

namespace q3 {

/// Numbers the clusters and returns their count. `deep`: leafs below a detail split share a cluster. Throws Error for
/// more clusters than a .bsp may have.
int NumberClusters(Tree &tree, bool deep);
/// Numbers the areas, the regions between area portals, and returns their count.
int FloodAreas(Tree &tree);

} // namespace q3
