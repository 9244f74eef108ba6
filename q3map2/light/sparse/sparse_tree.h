// GPL-2.0-or-later. Converts the octree to the nodes and values of the sparse SH grid.
#pragma once

#include "q3map2/bspfile/sparse_grid.h"
#include "q3map2/light/sparse/corner_weights.h"

namespace q3 {

/// The nodes and values that the file has. values: of the stored corners, in the order of corners.Stored(). A cell owns
/// its lower corner alone, so cells without open space are split where a stored or hanging corner is not theirs.
SparseGridTree MakeSparseTree(Octree tree, const LatticePoints &light, const CornerWeights &corners,
                              const SparseLattice &lattice, const std::vector<ShFloats> &values);

} // namespace q3
