// GPL-2.0-or-later. How many points of an SH light grid are in the open.
#pragma once

#include "q3map2/bspfile/bspfile.h"

#include <cstddef>

namespace q3 {

/// Numbers of SH grid points by position and value; each point is in one of the three. Printed by light and -info.
struct GridShares {
    std::size_t open = 0;     ///< in open space
    std::size_t filled = 0;   ///< in solid, not zero: light taken from points around
    std::size_t darkVoid = 0; ///< in solid, all zero
};

GridShares CountGridShares(const Bsp &bsp, const LightGridSH &grid);

} // namespace q3
