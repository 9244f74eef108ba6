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

/// Statistics of the bake of a grid that names lights.
struct NamedStats {
    std::size_t lights = 0;                     ///< in the table
    std::size_t cells = 0;                      ///< with open space
    std::size_t points = 0;                     ///< stored
    std::size_t shares = 0;                     ///< stored, of all points
    std::size_t samples = 0;                    ///< positions inside cells
    std::size_t bytes = 0;                      ///< of the lump
    std::map<std::string, std::size_t> dropped; ///< lights with a style that some cells do not name: number of cells
    bool isFull = false;                        ///< with -shadaptive: its limit of bytes is used up
    std::optional<GridSHError> measured;        ///< with -shadaptive
};

/// Bakes the grid with cells of a layout. Points hold the visible shares of the lights whose naming lowers the error
/// inside the cells around them most, and the rest of the light, both fitted to samples inside the cells. The result
/// does not depend on the number of threads.
NamedGridSH BakeNamedGrid(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
                          GridStats &work, NamedStats &result);

/// Error of the grid at random receivers, without lights that have a style. exact: of the others.
GridSHError ErrorOfNamedGrid(const ExactReceivers &exact, const NamedGridSH &grid);

/// Prints the size and, with -shadaptive, the error, and why it is above the goal. Warns if the lump exceeds the
/// budget.
void PrintNamedStats(const NamedStats &stats, const SparseGoal &goal, Log &log);

} // namespace q3
