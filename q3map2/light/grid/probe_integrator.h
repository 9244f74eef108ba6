// GPL-2.0-or-later. SH coefficients at points in the open, and their arithmetic.
#pragma once

#include "libs/sh/sh.h"
#include "q3map2/bspfile/bsp_records.h"
#include "q3map2/light/grid/grid_bricks.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace q3 {

/// Floats per point: nine coefficients for each of three channels.
inline constexpr std::size_t kSHFloats = 27;
static_assert(sizeof(bspGridPointSH_t) == kSHFloats * sizeof(float));
/// Coefficients of a point: coefficient k of a channel is at 3 k + channel. 1 = byte 255.
using SHFloats = std::array<float, kSHFloats>;

/// Mean over all directions, of the brightest channel. 1 = byte 255.
inline float MeanLight(const SHFloats &light) {
    return float(kSHC0) * std::max({light[0], light[1], light[2]});
}

/// sum += factor * value.
inline void AddScaled(float factor, const SHFloats &value, SHFloats &sum) {
    for (std::size_t i = 0; i < kSHFloats; ++i)
        sum[i] += factor * value[i];
}
inline void AddScaled(float factor, const bspGridPointSH_t &value, bspGridPointSH_t &sum) {
    for (std::size_t k = 0; k < value.coeffs.size(); ++k)
        for (std::size_t channel = 0; channel < 3; ++channel)
            sum.coeffs[k][channel] += factor * value.coeffs[k][channel];
}

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
    /// blocks. seed: of the random choice among faint lights, which is the same for all blocks. observer: sees the
    /// lights, or null.
    template <typename Store>
    void Trace(std::vector<ReceiverBatch> &blocks, std::uint64_t seed, GridStats &work, const Store &store,
               LightObserver *observer = nullptr) const {
        StoreAll(blocks, Sums(blocks, seed, LightPart::Whole, work, observer), store);
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
                     const Store &store, LightObserver *observer = nullptr) const {
        std::vector<ChannelSums> sums = Sums(blocks, seed, LightPart::Strong, work, observer);
        std::size_t next = 0;
        for (std::size_t block = 0; block < blocks.size(); ++block)
            for (std::size_t i = 0; i < blocks[block].count; ++i)
                AddLightAt(weakOf(next++), i, sums[block]);
        StoreAll(blocks, sums, store);
    }

  private:
    std::vector<ChannelSums> Sums(std::vector<ReceiverBatch> &blocks, std::uint64_t seed, LightPart part,
                                  GridStats &work, LightObserver *observer = nullptr) const;
    /// Adds floodlight and bounced light.
    void AddSurroundings(std::span<const ReceiverBatch> blocks, std::vector<ChannelSums> &sums, GridStats &work) const;
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
    IncidentLightTracer lighting_;
};

} // namespace q3
