// GPL-2.0-or-later. Clusters that see a surface.
#pragma once

#include "q3map2/light/scene/light_space.h"

#include <cstdint>
#include <vector>

namespace q3 {

/// Filter for the positions from which a surface may be lit: their cluster must see a cluster of the surface. Caches
/// PVS results, so it is not thread-safe: use one object per thread.
class VisibleClusters {
  public:
    /// `clusters`: of the surface; empty: all are allowed. Keeps references to both.
    VisibleClusters(const BspSpace &space, const std::vector<int> &clusters)
        : space_(space), clusters_(clusters), known_(clusters.empty() ? 0 : std::size_t(space.ClusterCount())) {}
    /// The cluster, or kSolidCluster if it is not allowed.
    int ClusterIfAllowed(int cluster);

  private:
    enum Known : std::uint8_t { Unknown, No, Yes };
    const BspSpace &space_;
    const std::vector<int> &clusters_;
    std::vector<Known> known_; ///< by cluster
};

} // namespace q3
