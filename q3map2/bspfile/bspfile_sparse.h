// GPL-2.0-or-later. The BSPX lump LIGHTGRID_SH_SPARSE.
#pragma once

#include "q3map2/bspfile/bsp.h"

#include <cstddef>
#include <string_view>
#include <vector>

namespace q3 {

struct ByteSource;
struct FilePart;

/// The head of the lump of a grid.
bspSparseGridHeader_t HeaderOf(const SparseGridSH &grid);
/// Reads the lump from a file. name: of the file, for errors, which are those of DecodeSparseGrid.
SparseGridSH ReadSparseGrid(const ByteSource &file, const FilePart &part, std::string_view name);
/// Sets `children` and `points` of all nodes: the running sums of inner children and of stored cells.
void NumberSparseNodes(SparseGridSH &grid);
/// Numbers of cells of a level of the tree whose lower corner is stored, is hanging, or has no value.
struct SparseLevelCounts {
    std::size_t stored = 0, hanging = 0, empty = 0;
};
/// For each level that has nodes, the largest cells first. The grid is one that CheckSparseGrid accepts.
std::vector<SparseLevelCounts> CountSparseLevels(const SparseGridSH &grid);
/// Errors: numbers out of range, indexes that are not running sums, a tree that has other nodes or points.
void CheckSparseGrid(const SparseGridSH &grid, std::string_view name);

} // namespace q3
