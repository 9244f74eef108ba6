// GPL-2.0-or-later. The sparse SH grid as it is stored.
#pragma once

#include "q3map2/bspfile/sparse_grid.h"
#include "q3map2/light/sparse/corner_weights.h"

namespace q3 {

/// The tree with one value for each stored corner, in the order of corners.Stored(). Splits cells without open space
/// where a corner that is needed lies in them, since only the lower corner of a cell has a place in the file.
SparseGridTree MakeSparseTree(Octree tree, const LatticePoints &light, const CornerWeights &corners,
                              const SparseLattice &lattice, const std::vector<ShFloats> &values);

} // namespace q3
