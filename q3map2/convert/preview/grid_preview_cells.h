// GPL-2.0-or-later. Cells of the sparse SH grid by position. Internal to the grid preview.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/sparse_grid.h"

#include <optional>

namespace q3 {

/// A cell: its lower corner and log2 of its edge, both in smallest cells.
struct SparseCell {
    Int3 low{};
    int size = 0;
    bool operator==(const SparseCell &) const = default;
};

/// The cell that contains a position; nothing outside the grid, which must be valid.
std::optional<SparseCell> SparseCellAt(const SparseGridSH &grid, const Vec3f &position);
/// Color of cells of that SparseCell::size: red for the smallest, then along the hues; repeats after six.
Vec3f SparseCellColor(int size);

} // namespace q3
