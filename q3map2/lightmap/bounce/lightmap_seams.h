// GPL-2.0-or-later. Neighboring luxels across the seams between lightmaps.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

#include <span>
#include <vector>

namespace q3 {

/// For luxels near the rim of a raw lightmap: those of other lightmaps around them, nearly in the same plane, with
/// similar normals and in sight. Const after construction.
class LightmapSeams {
  public:
    struct Neighbor {
        std::uint32_t lightmap, luxel; ///< of the super grid
        float dx, dy;                  ///< offset from the luxel, in luxels of its own lightmap
    };

    /// reach: of the window, luxels to each side, and twice as many of a super grid. minCosine: least cosine between
    /// normals.
    LightmapSeams(const SurfaceInputs &in, const SurfaceLight &surfaces, int reach, float minCosine);

    /// The neighbors of a luxel, in an order that does not depend on threads; none unless it is near the rim.
    std::span<const Neighbor> NeighborsAcross(std::size_t lightmap, std::size_t luxel) const;

  private:
    struct RimLuxel {
        std::uint32_t lightmap, luxel, first; ///< first: in neighbors_
    };
    struct Finder;
    std::vector<RimLuxel> rims_;        // by lightmap, then luxel; then a sentinel
    std::vector<std::size_t> firstRim_; // in rims_, by lightmap
    std::vector<Neighbor> neighbors_;
};

} // namespace q3
