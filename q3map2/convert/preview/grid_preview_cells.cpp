// GPL-2.0-or-later. Cells of the sparse SH grid by position.
#include "q3map2/convert/preview/grid_preview_cells.h"

#include <array>
#include <bit>

namespace q3 {

std::optional<SparseCell> SparseCellAt(const SparseGridSH &grid, const Vec3f &position) {
    SparseCell cell;
    std::size_t root = 0, stride = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double at = (double(position[axis]) - double(grid.mins[axis])) / double(grid.cell[axis]);
        if (!(at >= 0 && at < double(grid.roots[axis] << grid.levels)))
            return std::nullopt;
        cell.low[axis] = std::int32_t(at);
        root += stride * std::size_t(cell.low[axis] >> grid.levels);
        stride *= std::size_t(grid.roots[axis]);
    }
    const SparseGridNode *node = &grid.nodes[root];
    for (cell.size = grid.levels - 1;; --cell.size) {
        const auto bit = [&](std::size_t axis) { return unsigned(cell.low[axis] >> cell.size & 1); };
        const unsigned octant = bit(0) | bit(1) << 1 | bit(2) << 2, before = (1u << octant) - 1;
        if ((node->inner >> octant & 1) == 0)
            break;
        node = &grid.nodes[node->children + std::size_t(std::popcount(node->inner & before))];
    }
    for (std::int32_t &low : cell.low)
        low = low >> cell.size << cell.size;
    return cell;
}

Vec3f SparseCellColor(int size) {
    static constexpr std::array<Vec3f, 6> kColors = {Vec3f{1, 0.3f, 0.25f}, {1, 0.75f, 0.2f}, {0.45f, 0.9f, 0.3f},
                                                     {0.25f, 0.85f, 0.9f},  {0.35f, 0.5f, 1}, {0.8f, 0.45f, 1}};
    return kColors[std::size_t(size) % kColors.size()];
}

} // namespace q3
