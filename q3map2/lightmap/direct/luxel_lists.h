// GPL-2.0-or-later. Culling of lights for a raw lightmap.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

#include <cstdint>
#include <vector>

namespace q3 {

/// The lights of a pass, and a row of bits for each cluster: the lights it may see.
class LuxelLights {
  public:
    LuxelLights(const std::vector<Light> &lights, const BspSpace &space);

  private:
    friend class LuxelLightList;
    const std::vector<Light> &lights_;
    std::size_t words_ = 0;
    std::vector<std::uint64_t> suns_;
    std::vector<std::uint64_t> rows_; ///< words_ for each cluster; without suns
};

/// The lights that may reach a raw lightmap: seen from one of its clusters, with the lightmap in their envelope, and on
/// the front side of a planar one. Reused from lightmap to lightmap.
class LuxelLightList {
  public:
    void Build(const LuxelLights &all, const RawLightmap &lightmap, bool sunOnly);
    const std::vector<const Light *> &Lights() const { return list_; }

  private:
    std::vector<const Light *> list_;
    std::vector<std::uint64_t> seen_;
    std::vector<int> clusters_;
};

} // namespace q3
