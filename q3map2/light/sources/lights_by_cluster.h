// GPL-2.0-or-later. Which lights each cluster may see.
#pragma once

#include "q3map2/light/sources/light_sources.h"

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace q3 {

/// A row of bits per cluster, a bit per light. Keeps a reference to the lights.
class LightsByCluster {
  public:
    /// sunsEverywhere: suns count as seen from every cluster, whatever the visibility data says.
    LightsByCluster(const std::vector<Light> &lights, bool sunsEverywhere);

    /// Calls use(number of the light) in order for every light that one of the clusters may see, and returns how many
    /// it left out.
    template <typename Use> std::size_t ForEach(std::span<const int> clusters, const Use &use) const {
        std::vector<std::uint64_t> any = everywhere_;
        for (const int cluster : clusters)
            if (cluster >= 0 && std::size_t(cluster) < rows_.size())
                for (std::size_t word = 0; word < any.size(); ++word)
                    any[word] |= rows_[std::size_t(cluster)][word];
        std::size_t used = 0;
        for (std::size_t word = 0; word < any.size(); ++word)
            for (std::uint64_t bits = any[word]; bits != 0; bits &= bits - 1, ++used)
                use(word * 64 + std::size_t(std::countr_zero(bits)));
        return lights_.size() - used;
    }
    const std::vector<Light> &Lights() const { return lights_; }

  private:
    const std::vector<Light> &lights_;
    std::vector<std::uint64_t> everywhere_;        ///< lights that every cluster may see
    std::vector<std::vector<std::uint64_t>> rows_; ///< by cluster: lights that it may see, without those of everywhere_
};

} // namespace q3
