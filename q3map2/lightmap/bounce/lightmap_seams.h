// GPL-2.0-or-later. Where lightmaps touch: luxels across the joint.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

#include <span>
#include <vector>

namespace q3 {

/// Luxels near the rim of a raw lightmap and those of other lightmaps around them that face the same way, in sight.
/// Const after construction.
class LightmapSeams {
  public:
    struct Neighbour {
        std::uint32_t lightmap, luxel; ///< of the super grid
        float dx, dy;                  ///< from the luxel, in steps of its own lightmap
    };

    /// reach: luxels to each side, twice as many of a super grid. alike: least cosine between normals.
    LightmapSeams(const SurfaceInputs &in, const SurfaceLight &surfaces, int reach, float alike);

    /// In a fixed order.
    std::span<const Neighbour> NeighborsAcross(std::size_t lightmap, std::size_t luxel) const;

  private:
    struct Rim {
        std::uint32_t lightmap, luxel, first;
    };
    struct Finder;
    std::vector<Rim> rims_;            // by lightmap, then luxel; the last one is an end
    std::vector<std::size_t> firstOf_; // in rims_, by lightmap
    std::vector<Neighbour> neighbours_;
};

} // namespace q3
