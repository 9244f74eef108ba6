// GPL-2.0-or-later. Mapped luxels of a raw lightmap in blocks of 16 neighbours.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

#include <cstdint>
#include <span>
#include <vector>

namespace q3 {

/// Blocks of one raw lightmap, with what is needed to leave out lights that cannot reach them. Reused from lightmap to
/// lightmap.
class LuxelBlocks {
  public:
    void Build(const RawLightmap &lightmap);

    std::size_t Count() const { return samples_.size(); }
    SurfaceReceiverBatch &Samples(std::size_t block) { return samples_[block]; }
    const SurfaceReceiverBatch &Samples(std::size_t block) const { return samples_[block]; }
    /// Number in the super grid of each place of a block.
    const std::array<std::uint32_t, kPacketSize> &Luxels(std::size_t block) const { return luxels_[block]; }
    /// block * kPacketSize + lane of a luxel of the super grid; -1: not mapped.
    std::int32_t SlotOf(std::size_t luxel) const { return slots_[luxel]; }

    /// Appends the blocks that the light may reach to `reached`, in order.
    void Reached(const Light &light, const SurfaceLightSettings &settings, std::vector<std::uint32_t> &reached);

  private:
    void AddLuxel(const RawLightmap &lightmap, std::size_t luxel);
    void FinishBlock();
    int ClusterSlot(int cluster);

    std::vector<SurfaceReceiverBatch> samples_;
    std::vector<std::array<std::uint32_t, kPacketSize>> luxels_;
    std::vector<std::int32_t> slots_;

    // By block, padded to whole packets: a ball around its receivers; their common normal (zero when they differ) and
    // how far they reach along it; number of their cluster in clusters_, 0 when they differ.
    std::vector<float> x_, y_, z_, radius_, nx_, ny_, nz_, thickness_;
    std::vector<std::int32_t> clusterSlot_;
    std::vector<int> clusters_;
    std::vector<std::int32_t> seen_, keep_; ///< -1: yes
};

} // namespace q3
