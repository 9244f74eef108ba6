// GPL-2.0-or-later. Bounced light on the luxels of a lightmap.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

#include <vector>

namespace q3 {

/// Light by luxel of the super grid, byte scale; zero where a luxel is not mapped.
struct BounceEstimate {
    std::vector<Vec3f> irradiance;
    ChannelImages channels;
    std::vector<Vec3f> directions; ///< for deluxe pages, see RawLightmap::directions; else empty

    /// All zero.
    BounceEstimate(const RawLightmap &raw, bool deluxe)
        : irradiance(raw.luxelClusters.size()),
          channels(raw.channels.Count(), std::vector<Vec3f>(raw.luxelClusters.size())),
          directions(deluxe ? raw.luxelClusters.size() : 0) {}
};

} // namespace q3
