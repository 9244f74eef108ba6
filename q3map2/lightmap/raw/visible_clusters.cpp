// GPL-2.0-or-later. Clusters that see a surface.
#include "q3map2/lightmap/raw/visible_clusters.h"

namespace q3 {

int VisibleClusters::ClusterIfAllowed(int cluster) {
    if (cluster < 0 || known_.empty())
        return cluster;
    Known &known = known_[std::size_t(cluster)];
    if (known == Unknown) {
        known = No;
        for (const int own : clusters_)
            if (space_.Visible(own, cluster)) {
                known = Yes;
                break;
            }
    }
    return known == Yes ? cluster : kSolidCluster;
}

} // namespace q3
