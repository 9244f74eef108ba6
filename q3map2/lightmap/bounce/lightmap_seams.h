// GPL-2.0-or-later. Neighboring luxels across the seams between lightmaps.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

#include <span>
#include <vector>

namespace q3 {

/// For each luxel near the rim of a raw lightmap: the luxels of other lightmaps around it that are nearly in its plane,
/// have similar normals and are in its line of sight. Const after construction.
class LightmapSeams {
  public:
    struct Neighbor {
        std::uint32_t lightmap, luxel; ///< of the super grid
        float dx, dy;                  ///< offset from the asked luxel, in super grid luxels of its lightmap
    };

    /// reach: half width of the window in luxels; doubled, in super luxels, if the lightmap is supersampled.
    /// minCosine: least cosine between normals.
    LightmapSeams(const SurfaceInputs &in, const SurfaceLight &surfaces, int reach, float minCosine);

    /// The neighbors of a luxel, in an order that does not depend on threads; none unless it is near the rim.
    std::span<const Neighbor> NeighborsAcross(std::size_t lightmap, std::size_t luxel) const;

  private:
    struct RimLuxel {
        std::uint32_t lightmap, luxel, first; ///< first: index of its neighbors in neighbors_
    };
    struct Finder;
    std::vector<RimLuxel> rims_;        // by lightmap, then luxel; the last is a sentinel
    std::vector<std::size_t> firstRim_; // index in rims_, by lightmap
    std::vector<Neighbor> neighbors_;
};

} // namespace q3
