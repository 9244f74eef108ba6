// GPL-2.0-or-later. Neighbouring receivers that are lit together.
#pragma once

#include "q3map2/light/batch/lanes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace q3 {

/// The clusters that the receivers of a batch are in. Neighbours are in few.
struct LaneClusters {
    std::size_t count = 0;
    std::array<int, kPacketSize> number{};     ///< each once
    std::array<unsigned, kPacketSize> lanes{}; ///< bits of the receivers in it, as LaneMask::Bits

    void Add(std::size_t lane, int cluster);
};

/// Up to sixteen neighbouring receivers: points in the open, of a light grid or between its points.
struct ReceiverBatch {
    std::size_t count = 0;
    Lanes3 position{}, rayOrigin{}; ///< rays start at the position or a hair beside, clear of solids
    LaneClusters clusters;
    std::array<std::uint32_t, kPacketSize> index{}; ///< of the grid point: seeds its sample patterns
    LaneMask wanted{};                              ///< receivers that take (more) light
    float faintResidual = 0; ///< light of faint sources not yet represented; see SelectFaintLight. Byte scale

    bool Full() const { return count == kPacketSize; }
    void Add(const Vec3f &at, const Vec3f &raysFrom, int clusterAt, std::uint32_t indexAt);
};

/// The same on surfaces: luxels or vertices. Rays start at the position.
struct SurfaceReceiverBatch : ReceiverBatch {
    Lanes3 normal{};       ///< unit
    bool twoSided = false; ///< light from behind counts too

    void Add(const Vec3f &at, const Vec3f &normalAt, int clusterAt);
};

/// The last batch, after a new one where that was full.
template <typename Batch> Batch &BatchWithRoom(std::vector<Batch> &batches) {
    if (batches.empty() || batches.back().Full())
        batches.emplace_back();
    return batches.back();
}

/// Number of batches that `count` receivers fill.
inline std::size_t BatchCount(std::size_t count) {
    return (count + kPacketSize - 1) / kPacketSize;
}

/// Receivers of batch number `batch` when all are taken in their order.
template <typename T> std::span<T> BatchOf(std::span<T> all, std::size_t batch) {
    const std::size_t first = batch * kPacketSize;
    return all.subspan(first, std::min(kPacketSize, all.size() - first));
}

} // namespace q3
