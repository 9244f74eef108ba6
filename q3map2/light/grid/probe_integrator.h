// GPL-2.0-or-later. SH coefficients at points in the open.
#pragma once

#include "q3map2/light/grid/brick_lighting.h"

#include <vector>

namespace q3 {

/// Computes the light at receivers of the SH grid: points of the grid and samples between them. Const after
/// construction; safe from several threads. Keeps references.
class ProbeIntegrator {
  public:
    ProbeIntegrator(const GridInputs &in, const std::vector<Light> &lights);

    /// Calls store(index of the receiver, coefficients) for every receiver of the blocks of a brick: light of all
    /// lights, bounced light, floodlight, ambient and minimum light, scaled as stored. seed: of the random choice among
    /// faint lights, which is the same for all blocks.
    template <typename Store>
    void Trace(std::vector<ReceiverBatch> &blocks, std::uint64_t seed, GridStats &work, const Store &store) const {
        const std::vector<bspGridPointSH_t> values = Values(blocks, seed, work);
        std::size_t next = 0;
        for (const ReceiverBatch &receivers : blocks)
            for (std::size_t i = 0; i < receivers.count; ++i)
                store(receivers.index[i], values[next++]);
    }

  private:
    std::vector<bspGridPointSH_t> Values(std::vector<ReceiverBatch> &blocks, std::uint64_t seed, GridStats &work) const;

    const GridInputs &in_;
    BrickLighting lighting_;
};

} // namespace q3
