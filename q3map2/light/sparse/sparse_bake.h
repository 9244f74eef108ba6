// GPL-2.0-or-later. Bakes the sparse SH grid: small cells where the light changes, large ones elsewhere.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/sparse_grid.h"
#include "q3map2/light/grid/gridsh_dering.h"
#include "q3map2/light/grid/smooth_light.h"
#include "q3map2/light/options/sparse_goal.h"

namespace q3 {

/// Statistics of the bake of a sparse grid.
struct SparseStats {
    std::size_t leafs = 0, stored = 0; ///< cells with open space; stored points
    std::size_t bytes = 0;             ///< of the lump
    double error = 0;                  ///< expected displayed error of interpolation: RMS, bytes
    DeringStats dering;                ///< with -shdering
};

/// Bakes a sparse SH grid from the uniform one and the light between its points. From the uniform grid's cells on,
/// cells with a large error of interpolation are split, down to edges of kMinCell, and others are joined, until the
/// goal is met; stored corners are fitted to the light inside the cells. uniform: before deringing; -shdering applies
/// to the result. The result does not depend on the number of threads.
SparseGridSH BakeSparseGrid(const GridInputs &in, const SmoothLight &light, const LightGridSH &uniform,
                            const SparseGoal &goal, GridStats &work, SparseStats &result);

/// A sparse grid from the points of a uniform one alone: its cells are joined, not split. radiance: the coefficients of
/// both are not convolved with the cosine.
SparseGridSH SparseFromUniform(const BspSpace &space, const LightGridSH &uniform, bool radiance, const SparseGoal &goal,
                               const JobPool &jobs, SparseStats &result);

/// Prints the size and the expected error. Warns if the lump exceeds the budget.
void PrintSparseStats(const SparseStats &stats, const SparseGoal &goal, Log &log);

} // namespace q3
