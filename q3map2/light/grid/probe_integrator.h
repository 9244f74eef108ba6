// GPL-2.0-or-later. SH coefficients at points in the open.
#pragma once

#include "q3map2/light/grid/brick_lighting.h"

#include <array>
#include <span>
#include <vector>

namespace q3 {

/// Sums of one channel at the receivers of a block, by coefficient; 1 = byte 255.
using ChannelSum = std::array<DoubleLanes, 9>;
using ChannelSums = std::array<ChannelSum, 3>;

/// Computes the light at receivers of the SH grid: points of the grid and samples between them. Const after
/// construction; safe from several threads. Keeps references.
class ProbeIntegrator {
  public:
    ProbeIntegrator(const GridInputs &in, const std::vector<Light> &lights);

    /// Calls store(number, coefficients) for every receiver of the blocks of a brick: light of all lights, bounced
    /// light, floodlight, ambient and minimum light, scaled as stored. number: of the receiver among those of all
    /// blocks. seed: of the random choice among faint lights, which is the same for all blocks.
    template <typename Store>
    void Trace(std::vector<ReceiverBatch> &blocks, std::uint64_t seed, GridStats &work, const Store &store) const {
        StoreAll(blocks, Sums(blocks, seed, LightPart::Whole, work), store);
    }
    /// Calls store(number, WeakLight) with the weak light, see LightPart, bounced light and floodlight. Not with
    /// -noskipsmooth.
    template <typename Store>
    void TraceWeak(std::vector<ReceiverBatch> &blocks, std::uint64_t seed, GridStats &work, const Store &store) const {
        const std::vector<ChannelSums> sums = Sums(blocks, seed, LightPart::Weak, work);
        std::size_t next = 0;
        for (std::size_t block = 0; block < blocks.size(); ++block)
            for (std::size_t i = 0; i < blocks[block].count; ++i)
                store(next++, LightAt(sums[block], i));
    }
    /// As Trace, for receivers whose weak light is known: weakOf(number) returns it, as TraceWeak stored it.
    template <typename WeakOf, typename Store>
    void TraceStrong(std::vector<ReceiverBatch> &blocks, std::uint64_t seed, GridStats &work, const WeakOf &weakOf,
                     const Store &store) const {
        std::vector<ChannelSums> sums = Sums(blocks, seed, LightPart::Strong, work);
        std::size_t next = 0;
        for (std::size_t block = 0; block < blocks.size(); ++block)
            for (std::size_t i = 0; i < blocks[block].count; ++i)
                AddLightAt(weakOf(next++), i, sums[block]);
        StoreAll(blocks, sums, store);
    }

  private:
    std::vector<ChannelSums> Sums(std::vector<ReceiverBatch> &blocks, std::uint64_t seed, LightPart part,
                                  GridStats &work) const;
    std::vector<bspGridPointSH_t> Values(std::span<const ReceiverBatch> blocks,
                                         std::span<const ChannelSums> sums) const;
    static bspGridPointSH_t LightAt(const ChannelSums &sums, std::size_t lane);
    static void AddLightAt(const bspGridPointSH_t &light, std::size_t lane, ChannelSums &sums);
    template <typename Store>
    void StoreAll(std::span<const ReceiverBatch> blocks, std::span<const ChannelSums> sums, const Store &store) const {
        const std::vector<bspGridPointSH_t> values = Values(blocks, sums);
        for (std::size_t i = 0; i < values.size(); ++i)
            store(i, values[i]);
    }

    const GridInputs &in_;
    BrickLighting lighting_;
};

} // namespace q3
