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

/// Light at the receivers of a block, without ambient and minimum light.
struct BlockSum {
    ChannelSums strong{}, weak{}; ///< see WeakShare; all is strong where lights are not split

    /// Adds a light. scale: its color, 1 = byte 255. split: incident.weak is set.
    void Add(const Vec3d &scale, const ProbeIncidentLight &incident, bool split);
    bspGridPointSH_t WeakOf(std::size_t lane) const;
    void SetWeak(std::size_t lane, const bspGridPointSH_t &light);
};

/// Computes the light at receivers of the SH grid: points of the grid and samples between them. Const after
/// construction; safe from several threads. Keeps references.
class ProbeIntegrator {
  public:
    ProbeIntegrator(const GridInputs &in, const std::vector<Light> &lights);

    /// Calls store(index of the receiver, coefficients, their weak part) for every receiver of the blocks of a brick:
    /// light of all lights, bounced light, floodlight, ambient and minimum light, scaled as stored. The weak part is
    /// as WeakLight; zero with -noskipsmooth. seed: of the random choice among faint lights, which is the same for all
    /// blocks.
    template <typename Store>
    void Trace(std::vector<ReceiverBatch> &blocks, std::uint64_t seed, GridStats &work, const Store &store) const {
        const std::vector<BlockSum> sums = Sums(blocks, seed, LightPart::Whole, work);
        const std::vector<bspGridPointSH_t> values = Values(blocks, sums);
        std::size_t next = 0;
        for (std::size_t block = 0; block < blocks.size(); ++block)
            for (std::size_t i = 0; i < blocks[block].count; ++i)
                store(blocks[block].index[i], values[next++], sums[block].WeakOf(i));
    }
    /// The same for receivers whose weak light, WeakLight weakOf(number), is known: traces the strong light only.
    /// number: of the receiver among those of all blocks, also what `store` is called with.
    template <typename WeakOf, typename Store>
    void TraceStrong(std::vector<ReceiverBatch> &blocks, std::uint64_t seed, GridStats &work, const WeakOf &weakOf,
                     const Store &store) const {
        std::vector<BlockSum> sums = Sums(blocks, seed, LightPart::Strong, work);
        std::size_t next = 0;
        for (std::size_t block = 0; block < blocks.size(); ++block)
            for (std::size_t i = 0; i < blocks[block].count; ++i)
                sums[block].SetWeak(i, weakOf(next++));
        const std::vector<bspGridPointSH_t> values = Values(blocks, sums);
        for (std::size_t i = 0; i < values.size(); ++i)
            store(i, values[i]);
    }

  private:
    std::vector<BlockSum> Sums(std::vector<ReceiverBatch> &blocks, std::uint64_t seed, LightPart part,
                               GridStats &work) const;
    std::vector<bspGridPointSH_t> Values(std::span<const ReceiverBatch> blocks, std::span<const BlockSum> sums) const;

    const GridInputs &in_;
    BrickLighting lighting_;
};

} // namespace q3
