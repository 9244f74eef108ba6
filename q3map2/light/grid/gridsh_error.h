// GPL-2.0-or-later. How far the SH grid is from the light that it stands for, where players can be.
#pragma once

#include "q3map2/light/grid/light_grid.h"
#include "q3map2/light/sources/light_sources.h"

#include <cstddef>
#include <vector>

namespace q3 {

/// Differences between what a game shows from the grid and what a grid point at the same position would hold. Displayed
/// light: cut to 0..255 first. In 255ths.
struct GridSHError {
    std::size_t receivers = 0; ///< 0: nothing below counts
    double rms = 0;            ///< over receivers, 26 directions and 3 channels
    double percentile95 = 0;   ///< of the absolute difference
    double leak = 0;    ///< share of receivers with less than 1 % of the map's mean light, shown with more than 5 %
    double doubled = 0; ///< percentile95 from every second point per axis, that is, with doubled cells
    double order = 2;   ///< percentile95 falls as this power of the cell size; 0.5 to 2
    double cpuSeconds = 0;
};

/// Compares at random receivers 16 units clear of solids, always the same ones: `grid`, as it is stored, with exact
/// light of `lights` (by SetupEnvelopes for the SH grid). Fewer receivers where little space is open.
GridSHError MeasureGridSH(const GridInputs &in, const LightGridSH &grid, const std::vector<Light> &lights,
                          std::size_t receivers = 2000);

/// Cell size with about half of percentile95 (few receivers close to bright lamps rule the RMS, and no cells help
/// those): whole units, at least 8.
Float3 CellOfHalfError(const Float3 &cell, const GridSHError &error);

/// For mappers; names the options that halve the error.
void PrintGridSHError(const GridSHError &error, const Float3 &cell, const Float3 &legacyCell, Log &log);

} // namespace q3
