// GPL-2.0-or-later. Which lights each cluster may see.
#include "q3map2/light/sources/lights_by_cluster.h"

namespace q3 {

LightsByCluster::LightsByCluster(const std::vector<Light> &lights, bool sunsEverywhere) : lights_(lights) {
    const std::size_t words = (lights.size() + 63) / 64;
    everywhere_.resize(words);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const std::vector<bool> &seenFrom = lights[i].seenFrom;
        const std::uint64_t bit = std::uint64_t(1) << (i % 64);
        if (seenFrom.empty() || (sunsEverywhere && lights[i].type == LightType::Sun)) {
            everywhere_[i / 64] |= bit;
            continue;
        }
        if (rows_.size() < seenFrom.size())
            rows_.resize(seenFrom.size(), std::vector<std::uint64_t>(words));
        for (std::size_t cluster = 0; cluster < seenFrom.size(); ++cluster)
            if (seenFrom[cluster])
                rows_[cluster][i / 64] |= bit;
    }
}

} // namespace q3
