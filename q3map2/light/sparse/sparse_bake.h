// GPL-2.0-or-later. Bakes the sparse SH grid: small cells where the light changes, large ones elsewhere.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bspfile_sparse.h"
#include "q3map2/light/grid/gridsh_error.h"
#include "q3map2/light/grid/light_gridsh.h"
#include "q3map2/light/grid/weak_field.h"
#include "q3map2/light/options/light_options.h"

#include <optional>

namespace q3 {

/// Why a sparse grid is not finer than it is.
enum class RefinementStop {
    ExpectedToMeetGoal, ///< its expected error meets the goal; the measured one may not, after all attempts
    ByteLimit,          ///< without a budget: it would take more than half of the bytes of the uniform grid
    LittleExpectedGain, ///< smaller cells would hardly reduce its expected error
    NoMeasuredGain,     ///< more cells did not reduce its measured error
    LastThreshold,      ///< all cells are split whose expected squared error times volume is above the last threshold
    NotRefined          ///< it is made from a uniform grid, whose cells are not split
};

/// Statistics of the bake of a sparse grid.
struct SparseStats {
    std::size_t leafs = 0;               ///< cells with open space
    std::size_t storedPoints = 0;        ///< corners with a value in the lump
    std::size_t bytes = 0;               ///< of the lump
    double expectedError = 0;            ///< displayed error of interpolation: RMS, bytes
    std::optional<GridSHError> measured; ///< of the finished grid, where players can be; none: nothing was traced
    std::size_t nearLightSamples = 0;    ///< positions near lights
    double nearLightError = 0;           ///< displayed error there: RMS, bytes
    RefinementStop stop = RefinementStop::ExpectedToMeetGoal;
    DeringStats dering; ///< with -shdering
};

/// Bakes a sparse SH grid from the uniform one and the light between its points. Cells are split, down to edges of
/// kMinCubicCell: first near lights while the error there is large, then where the expected error is large. Others are
/// joined. This ends when the goal is met, as measured at random positions. Stored corners are fitted to the light
/// inside the cells. uniform: before deringing; -shdering applies to the result. lights: those of `light`. The result
/// does not depend on the number of threads.
SparseGridSH BakeSparseGrid(const GridInputs &in, const std::vector<Light> &lights, const LightAtPositions &light,
                            const LightGridSH &uniform, const SparseGoal &goal, GridStats &work, SparseStats &result);

/// A sparse grid from only the points of a uniform one: its cells are joined, not split. radiance: the coefficients of
/// both are not convolved with the cosine.
SparseGridSH SparseFromUniform(const BspSpace &space, const LightGridSH &uniform, bool radiance, const SparseGoal &goal,
                               const JobPool &jobs, SparseStats &result);

/// Prints the size and the error, and why it is above the goal. Warns if the lump exceeds the budget.
void PrintSparseStats(const SparseStats &stats, const SparseGoal &goal, Log &log);

} // namespace q3
