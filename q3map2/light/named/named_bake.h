// GPL-2.0-or-later. Bakes the SH light grid that names lights.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bspfile_named.h"
#include "q3map2/light/grid/gridsh_error.h"
#include "q3map2/light/grid/light_gridsh.h"

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace q3 {

/// Size and error of a baked grid that names lights.
struct NamedStats {
    std::size_t lights = 0;                     ///< that points could name: size of LightTable
    std::size_t cells = 0;                      ///< with open space
    std::size_t points = 0;                     ///< stored
    std::size_t shares = 0;                     ///< stored, sum over all points
    std::size_t samples = 0;                    ///< positions inside cells
    std::size_t bytes = 0;                      ///< of the lump
    std::map<std::string, std::size_t> dropped; ///< by label of a light with a style: cells that cannot name it
    bool isFull = false;                        ///< with -shadaptive: the lump is at its limit of bytes
    bool takesLong = false; ///< with -shadaptive: refinement ended because it would take longer than the uniform grid
    std::optional<GridSHError> measured; ///< with -shadaptive: error of the grid
};

/// Bakes the grid. Its first cells are those of the layout, and with -shadaptive they are split and joined. A point
/// holds the visible shares of the lights whose naming lowers the error in the cells around it most, and the rest of
/// the light; both are fitted to samples inside the cells. The result does not depend on the number of threads.
NamedGridSH BakeNamedGrid(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
                          GridStats &work, NamedStats &result);

/// Error of the light of style 0 of the grid. exact: receivers with the light of style 0.
GridSHError ErrorOfNamedGrid(const ExactReceivers &exact, const NamedGridSH &grid);

/// Prints the size and, with -shadaptive, the error; also the reason if it is above the goal. Warns if the lump exceeds
/// the budget.
void PrintNamedStats(const NamedStats &stats, const SparseGoal &goal, Log &log);

} // namespace q3
