// GPL-2.0-or-later. Which lights a surface has to look at.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

#include <cstdint>
#include <vector>

namespace q3 {

/// The lights of a pass, with those that each cluster may see as rows of bits.
class LuxelLights {
  public:
    LuxelLights(const std::vector<Light> &lights, const BspSpace &space);

  private:
    friend class LuxelLightList;
    const std::vector<Light> &lights_;
    std::size_t words_ = 0;
    std::vector<std::uint64_t> suns_;
    std::vector<std::uint64_t> rows_; ///< words_ a cluster; suns are in none
};

/// The lights that may reach a raw lightmap: of the right side, near enough, in a cluster that one of its clusters
/// sees. Reused from lightmap to lightmap.
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
