// GPL-2.0-or-later. Nodes and values of the sparse grid in the file, from an octree.
#pragma once

#include "q3map2/bspfile/bspfile_sparse.h"
#include "q3map2/light/sparse/corner_fit.h"

#include <vector>

namespace q3 {

/// The nodes that a file has, and for each stored cell, in their order, the index of its point in corners.Stored().
struct StoredTree {
    std::vector<SparseGridNode> nodes;
    std::vector<std::uint32_t> order;
};
/// The tree of the file. In it a cell owns only its lower corner, so cells without open space are split until each
/// stored or hanging corner of a leaf is the lower corner of a cell.
StoredTree StoreTree(Octree tree, const LatticePoints &points, const CornerWeights &corners,
                     const JobPool &jobs = JobPool(1));
/// The nodes and values that the file has. values: of the stored corners, in the order of corners.Stored().
SparseGridTree MakeSparseTree(StoredTree stored, const SparseLattice &lattice, const std::vector<SHFloats> &values,
                              const JobPool &jobs = JobPool(1));

} // namespace q3
