// GPL-2.0-or-later. Which lights a surface has to look at.
#pragma once

#include "q3map2/light/sources/lights_by_cluster.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <vector>

namespace q3 {

/// The lights that may reach a raw lightmap: of the right side, near enough, in a cluster that one of its clusters
/// sees. Reused from lightmap to lightmap.
class LuxelLightList {
  public:
    /// all: of the pass, with suns everywhere.
    void Build(const LightsByCluster &all, const RawLightmap &lightmap, bool sunOnly);
    const std::vector<const Light *> &Lights() const { return list_; }

  private:
    std::vector<const Light *> list_;
};

} // namespace q3
