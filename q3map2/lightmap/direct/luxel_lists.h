// GPL-2.0-or-later. Culling of lights for a raw lightmap.
#pragma once

#include "q3map2/light/sources/lights_by_cluster.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <vector>

namespace q3 {

/// The lights that may reach a raw lightmap: seen from one of its clusters, with the lightmap in their envelope, and on
/// the front side of a planar one. Reused from lightmap to lightmap.
class LuxelLightList {
  public:
    /// all: the lights of the pass, made with sunsEverywhere.
    void Build(const LightsByCluster &all, const RawLightmap &lightmap, bool sunOnly);
    const std::vector<const Light *> &Lights() const { return list_; }

  private:
    std::vector<const Light *> list_;
};

} // namespace q3
