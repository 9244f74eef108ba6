// GPL-2.0-or-later. Counts of the work of lighting.
#pragma once

#include "q3map2/light/batch/ray_packet.h"

#include <cstdint>

namespace q3 {

/// Pairs of a light and a receiver by outcome. Each worker has its own; they are summed for the log.
struct ContributionCounts : RayCounts {
    std::uint64_t pairs = 0;          ///< pairs considered
    std::uint64_t skippedFacing = 0;  ///< behind an emitter, outside a cone or beyond the reach
    std::uint64_t skippedPvs = 0;     ///< hidden from each other by the visibility lump
    std::uint64_t skippedFaint = 0;   ///< with a light so faint that others represent it
    std::uint64_t skippedMoments = 0; ///< with an emitter approximated by a point or a few samples
    std::uint64_t skippedProbes = 0;  ///< with a faint area light, its visibility from one ray
    std::uint64_t skippedCoarse = 0;  ///< with visibility taken from other receivers of the batch
    std::uint64_t refined = 0;        ///< with an area light partly hidden, traced with many rays

    ContributionCounts &operator+=(const ContributionCounts &o) {
        rays += o.rays, pairs += o.pairs, skippedFacing += o.skippedFacing, skippedPvs += o.skippedPvs;
        skippedFaint += o.skippedFaint, skippedMoments += o.skippedMoments, skippedProbes += o.skippedProbes;
        skippedCoarse += o.skippedCoarse, refined += o.refined;
        return *this;
    }
};

} // namespace q3
