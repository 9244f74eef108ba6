// GPL-2.0-or-later. Optimal pruning of the octree: error against number of cells.
#pragma once

#include "q3map2/light/sparse/octree.h"

#include <limits>

namespace q3 {

/// Size and expected error of a pruned octree.
struct PrunedOctree {
    std::size_t leafs = 0; ///< with open space; about the number of stored points
    double volume = 0;     ///< open volume in smallest cells
    double error = 0;      ///< expected displayed error over the open volume: RMS, bytes
};

/// Turns inner nodes, except roots, into leafs so that the sum over all leafs of (squared error x open volume + price)
/// is least: the pruning of Breiman et al. (1984) and of Chou, Lookabaugh and Gray (1989). price: the Lagrange
/// multiplier of the number of leafs, bytes^2 times smallest cells. maxLamp: inner nodes with a larger OctreeCell::lamp
/// stay inner nodes. Sets `open` of inner nodes from their children.
PrunedOctree PruneOctree(Octree &tree, float price, float maxLamp = std::numeric_limits<float>::infinity());

} // namespace q3
