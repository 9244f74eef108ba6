// GPL-2.0-or-later. -filter: blur of light over luxels.
#include "q3map2/lightmap/direct/luxel_filter.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Calls use(cell, weight) for the cells of a row or column that count in the box around cell `at` of it. first:
/// cell 0; stride: from cell to cell; count: their number.
template <typename Use>
void ForBox(const LuxelSurroundings &around, std::size_t first, std::size_t stride, int count, int at, float radius,
            const Use &use) {
    const auto cellAt = [&](int k) { return first + stride * std::size_t(std::clamp(k, 0, count - 1)); };
    const auto inside = [&](int k) { return k >= 0 && k < count; };
    // Beyond the end of the walk a surface goes on as it does in the last cell.
    const auto blocked = [&](int k) {
        const CellState state = around.At(cellAt(k));
        return state == CellState::Blocked || (!inside(k) && state != CellState::Empty);
    };
    use(cellAt(at), 1.0f);
    const int most = int(std::min(std::ceil(radius + 0.5f) - 1, float(count)));
    for (int k = 1; k <= most; ++k) {
        if (blocked(at - k) || blocked(at + k))
            continue;
        const float weight = std::min(1.0f, radius + 0.5f - float(k));
        for (const int side : {at - k, at + k})
            if (inside(side))
                use(cellAt(side), weight);
    }
}

} // namespace

void LuxelFilter::Apply(const LuxelSurroundings &around, float radius, const std::vector<Vec3f> &values,
                        std::vector<Vec3f> &blurred) {
    const int width = around.Width(), height = around.Height();
    rows_.assign(values.size(), {});
    rowWeight_.assign(values.size(), 0);
    blurred.assign(values.size(), {});
    const auto holds = [&](std::size_t cell) {
        return around.At(cell) == CellState::Own || around.At(cell) == CellState::Tapped;
    };
    // A separable kernel: rows, then columns.
    for (int y = 0; y < height; ++y) {
        const std::size_t first = std::size_t(y) * std::size_t(width);
        for (int x = around.Reach(); x < width - around.Reach(); ++x)
            ForBox(around, first, 1, width, x, radius, [&](std::size_t from, float weight) {
                const float counts = holds(from) ? weight : 0;
                rows_[first + std::size_t(x)] += values[from] * counts;
                rowWeight_[first + std::size_t(x)] += counts;
            });
    }
    for (int y = around.Reach(); y < height - around.Reach(); ++y)
        for (int x = around.Reach(); x < width - around.Reach(); ++x) {
            const std::size_t cell = std::size_t(y) * std::size_t(width) + std::size_t(x);
            if (!holds(cell))
                continue;
            Vec3f sum;
            float weights = 0;
            ForBox(around, std::size_t(x), std::size_t(width), height, y, radius, [&](std::size_t from, float weight) {
                sum += rows_[from] * weight;
                weights += rowWeight_[from] * weight;
            });
            blurred[cell] = weights > 0 ? sum / weights : Vec3f{};
        }
}

} // namespace q3
