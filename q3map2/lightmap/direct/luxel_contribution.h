// GPL-2.0-or-later. The light of one source on a block of luxels, and sums of such light.
#pragma once

#include "q3map2/lightmap/direct/luxel_blocks.h"

namespace q3 {

/// Light of one pass for one style slot that is blurred by one radius: by block.
struct LuxelSum {
    std::size_t slot = 0;
    int radius = 0; ///< luxels of the super grid
    std::vector<Lanes3> color, direction;
};

/// All sums of a raw lightmap.
struct LuxelSums {
    std::vector<LuxelSum> sums;
    bool deluxe = false;
    std::size_t used = 0; ///< of `sums`; the others keep their memory

    void Clear() { used = 0; }
    /// The sum of that slot and radius; a new one is zero.
    LuxelSum &Find(std::size_t slot, int radius, std::size_t blocks);
};

/// What one light gives to a block: colours, and direction sums when there are any; zero where nothing.
struct LuxelIncidentLight {
    Lanes3 color{}, direction{};
    LaneMask lit{}, forced{};
};

/// Settings of a pass over one raw lightmap.
struct LuxelPass {
    SurfaceLightSettings settings;
    bool bounce = false, deluxe = false;
};

/// Light of one source at a block of samples, as it is added up. False: none at all.
bool LuxelContribution(const Light &light, const LuxelPass &pass, const LightScene &scene,
                       SurfaceReceiverBatch &samples, LuxelIncidentLight &out, ContributionCounts &counts);

} // namespace q3
