// GPL-2.0-or-later. How many points of an SH light grid are in the open.
#pragma once

#include "q3map2/bspfile/bspfile.h"

#include <cstddef>

namespace q3 {

/// SH grid points by position and value. Every point is one of the three. The light stage and -info print the same.
struct GridShares {
    std::size_t open = 0;     ///< in open space
    std::size_t filled = 0;   ///< in solid, with light taken from around
    std::size_t darkVoid = 0; ///< in solid, all zero
};

GridShares CountGridShares(const Bsp &bsp, const LightGridSH &grid);

} // namespace q3
