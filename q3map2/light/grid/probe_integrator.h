// GPL-2.0-or-later. SH coefficients at any place in the open.
#pragma once

#include "q3map2/light/grid/grid_bricks.h"
#include "q3map2/light/grid/light_grid.h"

#include <vector>

namespace q3 {

/// Lights receivers for the SH grid: points of the grid and what lies between them. Const after construction; safe from
/// several threads. Keeps references.
class ProbeIntegrator {
  public:
    ProbeIntegrator(const GridInputs &in, const std::vector<Light> &lights);

    /// Calls store(place index, coefficients) for every place of the blocks, which are near each other: `seed` makes
    /// their common choices. Light of all lights, floodlight, ambient and minimum, scaled as it is stored.
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
    LightsByCluster lights_;
    LightSettings settings_;
    float faint_;
};

} // namespace q3
