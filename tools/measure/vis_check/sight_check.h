// GPL-2.0-or-later. Checks that visibility data hides nothing that can be seen.
#pragma once

#include "q3map2/bspfile/bspfile.h"

#include <cstdint>

namespace q3 {

/// What CheckSight finds.
struct SightCheck {
    std::int64_t pairs = 0;   ///< pairs of points in open leafs
    std::int64_t clear = 0;   ///< of those: nothing solid between them
    std::int64_t hidden = 0;  ///< of those: one's cluster is not marked as seeing the other's
    std::int64_t missing = 0; ///< of those: eight parallel lines `margin` units around are clear too
    int from = -1, to = -1;   ///< clusters of the first one missing
};

/// Draws pairs of points that lie in open leafs: half of them anywhere in the world, half at random distances. The
/// tree tells whether something solid is between them. Error: no visibility data, or a world without open leafs.
SightCheck CheckSight(const Bsp &bsp, std::int64_t pairs, float margin, std::uint32_t seed);

} // namespace q3
