// GPL-2.0-or-later. Mapped luxels of a raw lightmap in blocks of 16 neighbors.
#pragma once

#include "q3map2/lightmap/direct/luxel_channels.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <cstdint>
#include <span>
#include <vector>

namespace q3 {

/// Blocks of one raw lightmap, with bounds by which lights that cannot reach them are culled. Reused from lightmap to
/// lightmap.
class LuxelBlocks {
  public:
    void Build(const RawLightmap &lightmap);

    std::size_t Count() const { return receivers_.size(); }
    SurfaceReceiverBatch &Receivers(std::size_t block) { return receivers_[block]; }
    const SurfaceReceiverBatch &Receivers(std::size_t block) const { return receivers_[block]; }
    /// Basis normals of the receivers; null if the lightmap has no such channels.
    const BasisLanes *Basis(std::size_t block) const { return basis_.empty() ? nullptr : &basis_[block]; }
    /// Index in the super grid of each receiver of a block.
    const std::array<std::uint32_t, kPacketSize> &Luxels(std::size_t block) const { return luxels_[block]; }
    /// block * kPacketSize + lane in it of a luxel of the super grid; -1: not mapped.
    std::int32_t LaneIndexOf(std::size_t luxel) const { return laneIndices_[luxel]; }

    /// Appends the indices of blocks that the light may reach to `reached`, in order.
    void FindReached(const Light &light, const SurfaceLightSettings &settings, std::vector<std::uint32_t> &reached);

  private:
    void AddLuxel(const RawLightmap &lightmap, std::size_t luxel);
    void FinishBlock();

    std::vector<SurfaceReceiverBatch> receivers_;
    std::vector<BasisLanes> basis_;
    std::vector<std::array<std::uint32_t, kPacketSize>> luxels_;
    std::vector<std::int32_t> laneIndices_;

    // By block, padded to whole packets: bounding sphere of the receivers, their common normal (zero if they differ),
    // and how far they are off the plane through the center with that normal.
    std::vector<float> x_, y_, z_, radius_, nx_, ny_, nz_, thickness_;
    std::vector<std::int32_t> keep_; ///< -1: the light of the latest FindReached may reach the block
};

} // namespace q3
