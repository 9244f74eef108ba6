// GPL-2.0-or-later. The light of one source on a block of luxels, and sums of such light.
#pragma once

#include "q3map2/lightmap/direct/luxel_blocks.h"
#include "q3map2/lightmap/direct/luxel_channels.h"

namespace q3 {

/// Sum of the light of sources with one style slot and one filter radius, by block.
struct LuxelSum {
    std::size_t slot = 0;
    float filterRadius = 0; ///< of the sources, Light::filterRadius; 0 for all if no surface blurs light
    std::vector<Lanes3> color, direction;
    std::vector<ChannelLanes> channels;
};

/// All sums of a raw lightmap.
struct LuxelSums {
    std::vector<LuxelSum> sums;
    bool deluxe = false, directional = false;
    std::size_t used = 0; ///< how many of `sums` hold values; the rest only keep their memory

    void Clear() { used = 0; }
    /// The sum of that slot and filter radius; a new one is zero.
    LuxelSum &FindOrAdd(std::size_t slot, float filterRadius, std::size_t blocks);
};

/// Light of one source at the receivers of a block; zero where none arrives.
struct LuxelIncidentLight {
    Lanes3 color{};
    Lanes3 direction{}; ///< unit vector to the source times the luminance of its light here; 0 unless deluxe
    LaneMask lit{};
    LaneMask filtered{}; ///< gets light above 1 before color, by a shadow ray that met a transparent surface
};

/// Settings of a pass over one raw lightmap.
struct LuxelPass {
    SurfaceLightSettings settings;
    bool bounce = false, deluxe = false;
    DirectionalChannels channels;
};

/// Receivers of a block and the basis normals of their luxels, null without basis channels.
struct LuxelReceivers {
    SurfaceReceiverBatch &batch;
    const BasisLanes *basis = nullptr;
};

/// Evaluates a source at a block of receivers. False: no light arrives, and `out` and `channels` are not set.
bool LuxelContribution(const Light &light, const LuxelPass &pass, const LightScene &scene,
                       const LuxelReceivers &receivers, LuxelIncidentLight &out, ChannelLanes &channels,
                       ContributionCounts &counts);

} // namespace q3
