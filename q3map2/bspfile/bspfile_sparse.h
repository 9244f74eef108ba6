// GPL-2.0-or-later. The BSPX lump LIGHTGRID_SH_SPARSE.
#pragma once

#include "q3map2/bspfile/bsp.h"

#include <string_view>

namespace q3 {

struct ByteSource;
struct FilePart;

/// The head that belongs to the grid.
bspSparseGridHeader_t HeaderOf(const SparseGridSH &grid);
/// Reads the lump. Errors: those of DecodeSparseGrid, with the name.
SparseGridSH ReadSparseGrid(const ByteSource &file, const FilePart &part, std::string_view name);
/// Errors: numbers out of range, indexes that are not running sums, a tree that has other nodes or points.
void CheckSparseGrid(const SparseGridSH &grid, std::string_view name);

} // namespace q3
