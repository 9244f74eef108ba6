// GPL-2.0-or-later. The SH grid without negative lobes.
#include "q3map2/light/grid/gridsh_dering.h"

#include "libs/sh/dering.h"
#include "q3map2/light/grid/gridsh_display.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace q3 {

DeringStats DeringPoint(bspGridPointSH_t &point, bool radiance) {
    std::array<ShVector, 3> channels;
    std::array<bool, 3> changed{};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        for (std::size_t k = 0; k < 9; ++k)
            channels[channel][k] = double(point.coeffs[k][channel]);
        changed[channel] = RemoveNegativeLobes(channels[channel]);
    }
    if (!changed[0] && !changed[1] && !changed[2])
        return {};
    const DisplayedLight before = DisplayLight(point, radiance);
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t k = 1; k < 9 && changed[channel]; ++k)
            point.coeffs[k][channel] = float(channels[channel][k]);
    const DisplayedLight after = DisplayLight(point, radiance);
    DeringStats stats{.points = 1};
    for (std::size_t i = 0; i < before.size(); ++i)
        stats.largestChange = std::max(stats.largestChange, double(std::abs(after[i] - before[i])));
    return stats;
}

DeringStats DeringGridSH(LightGridSH &grid, bool radiance, const JobPool &jobs) {
    constexpr std::size_t kPart = 4096;
    const std::size_t parts = (grid.points.size() + kPart - 1) / kPart;
    std::vector<DeringStats> work(parts);
    jobs.For(std::int64_t(parts), [&](std::int64_t part, int) {
        DeringStats &mine = work[std::size_t(part)];
        const std::size_t first = std::size_t(part) * kPart, last = std::min(grid.points.size(), first + kPart);
        for (std::size_t i = first; i < last; ++i) {
            const DeringStats point = DeringPoint(grid.points[i], radiance);
            mine.points += point.points;
            mine.largestChange = std::max(mine.largestChange, point.largestChange);
        }
    });
    DeringStats total;
    for (const DeringStats &part : work) {
        total.points += part.points;
        total.largestChange = std::max(total.largestChange, part.largestChange);
    }
    return total;
}

} // namespace q3
