// GPL-2.0-or-later. The sparse SH grid: fine where light is, coarse elsewhere.
#pragma once

#include "q3map2/bspfile/sparse_grid.h"
#include "q3map2/light/grid/light_grid.h"
#include "q3map2/light/sources/light_sources.h"

namespace q3 {

/// Statistics of the bake of a sparse grid.
struct SparseStats {
    std::size_t leafs = 0, stored = 0; ///< cells with open space; points
    std::size_t bytes = 0;             ///< of the lump
    double error = 0;                  ///< expected displayed error of interpolation: RMS, bytes
};

/// Bakes a sparse SH grid from the uniform one of the same lights. Starting at the uniform grid's cells, those whose
/// light interpolation does not give are split, down to 8 units, and those that are not needed are joined, until the
/// expected error is options.shErrorTarget or, with options.shBudget, until the lump has that many bytes. Corners are
/// fitted to the light inside the cells. The same for any number of threads.
SparseGridSH BakeSparseGrid(const GridInputs &in, const std::vector<Light> &lights, const LightGridSH &uniform,
                            GridStats &work, SparseStats &result);

} // namespace q3
