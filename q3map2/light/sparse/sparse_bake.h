// GPL-2.0-or-later. The sparse SH grid: fine where light is, coarse elsewhere.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/sparse_grid.h"
#include "q3map2/light/grid/gridsh_dering.h"
#include "q3map2/light/grid/smooth_light.h"
#include "q3map2/light/options/sparse_goal.h"

namespace q3 {

/// Statistics of the bake of a sparse grid.
struct SparseStats {
    std::size_t leafs = 0, stored = 0; ///< cells with open space; points
    std::size_t bytes = 0;             ///< of the lump
    double error = 0;                  ///< expected displayed error of interpolation: RMS, bytes
    DeringStats dering;                ///< with -shdering
};

/// Bakes a sparse SH grid from the uniform one, before deringing, and the light between its points; -shdering counts
/// for the result. Starting at the uniform grid's cells, those whose light interpolation does not give are split, down
/// to 8 units, and those that are not needed are joined, until the goal is met. Corners are fitted to the light inside
/// the cells. The same for any number of threads.
SparseGridSH BakeSparseGrid(const GridInputs &in, const SmoothLight &light, const LightGridSH &uniform,
                            const SparseGoal &goal, GridStats &work, SparseStats &result);

/// A sparse grid of the points of a uniform one alone. Its cells are joined, not split. radiance: the coefficients of
/// both are not convolved with the cosine.
SparseGridSH SparseFromUniform(const BspSpace &space, const LightGridSH &uniform, bool radiance, const SparseGoal &goal,
                               const JobPool &jobs, SparseStats &result);

/// Prints the size and the expected error. Warns if the lump exceeds the budget.
void PrintSparseStats(const SparseStats &stats, const SparseGoal &goal, Log &log);

} // namespace q3
