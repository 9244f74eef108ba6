// GPL-2.0-or-later. The best octree of a given cost.
#pragma once

#include "q3map2/light/sparse/octree.h"

namespace q3 {

/// What a pruned octree costs and shows.
struct PrunedOctree {
    std::size_t leafs = 0; ///< with open space; about as many as points that are stored
    double error = 0;      ///< expected RMS of the displayed error over the open volume, bytes
    double reducible = 0;  ///< the same without the smallest cells, which cannot be split
};

/// Turns inner nodes of the tree, except roots, into leafs such that the sum over all leafs of squared error times open
/// volume plus `price` is least (pruning of Breiman et al. and Chou, Lookabaugh and Gray). price: bytes^2 times
/// smallest cells.
PrunedOctree PruneOctree(Octree &tree, float price);

} // namespace q3
