// GPL-2.0-or-later. The light of one source on blocks of 16 luxels, its directional channels, and sums of such light.
#pragma once

#include "q3map2/light/transfer/light_sample.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <cstdint>
#include <span>
#include <vector>

namespace q3 {

/// The channels of sixteen receivers.
using ChannelLanes = std::array<Lanes3, kMaxChannels>;
/// The RNM basis normals of sixteen receivers.
using BasisLanes = std::array<Lanes3, DirectionalChannels::kBasis>;
inline void SetLane(std::size_t lane, const BasisNormals &normals, BasisLanes &basis) {
    for (std::size_t i = 0; i < normals.size(); ++i)
        basis[i].Set(lane, normals[i]);
}

/// Sets `out` to light of a source: `amount` at each receiver times `color` and the tint of `incident`; zero in lanes
/// that are not live.
void SetIncidentColor(const Vec3f &color, const SurfaceIncidentLight &incident, const Lanes &amount, Lanes3 &out);

/// Sets the channels of `incident`, light of a source with that color; zero in lanes that are not live. basis: null
/// without basis channels.
void SetChannels(const Vec3f &color, const SurfaceIncidentLight &incident, const DirectionalChannels &channels,
                 const BasisLanes *basis, ChannelLanes &out);

/// Blocks of one raw lightmap, with bounds by which lights that cannot reach them are culled. Reused from lightmap to
/// lightmap.
class LuxelBlocks {
  public:
    void Build(const RawLightmap &lightmap);
    /// The same with luxels that touch a wall moved off it, up to kMostOff game units along their surface. Luxels at
    /// the edge of a surface often lie in the plane of the next one, and a half of what shines on them seems hidden.
    void BuildOffWalls(const RawLightmap &lightmap, const BspSpace &space);
    static constexpr float kMostOff = 2;

    std::size_t Count() const { return receivers_.size(); }
    SurfaceReceiverBatch &Receivers(std::size_t block) { return receivers_[block]; }
    const SurfaceReceiverBatch &Receivers(std::size_t block) const { return receivers_[block]; }
    const std::vector<SurfaceReceiverBatch> &AllReceivers() const { return receivers_; }
    /// Basis normals of the receivers; null if the lightmap has no such channels.
    const BasisLanes *Basis(std::size_t block) const { return basis_.empty() ? nullptr : &basis_[block]; }
    /// Index in the super grid of each receiver of a block.
    const std::array<std::uint32_t, kPacketSize> &Luxels(std::size_t block) const { return luxels_[block]; }
    /// block * kPacketSize + lane in it of a luxel of the super grid; -1: not mapped.
    std::int32_t LaneIndexOf(std::size_t luxel) const { return laneIndices_[luxel]; }

    /// Appends the indices of blocks that the light may reach to `reached`, in order.
    void FindReached(const Light &light, const SurfaceLightSettings &settings, std::vector<std::uint32_t> &reached);

  private:
    void Build(const RawLightmap &lightmap, const BspSpace *space);
    void AddLuxel(const RawLightmap &lightmap, const Vec3f &position, std::size_t luxel);
    void FinishBlock();

    std::vector<SurfaceReceiverBatch> receivers_;
    std::vector<BasisLanes> basis_;
    std::vector<std::array<std::uint32_t, kPacketSize>> luxels_;
    std::vector<std::int32_t> laneIndices_;

    // By block, padded to whole packets: bounding sphere of the receivers, their common normal (zero if they differ),
    // and how far they are off the plane through the center with that normal.
    std::vector<float> x_, y_, z_, radius_, nx_, ny_, nz_, thickness_;
    std::vector<std::int32_t> mayReach_; ///< -1: the light of the latest FindReached may reach the block; else 0
};

/// Sum of the light of sources with one style slot and one filter radius, by block.
struct LuxelSum {
    std::size_t slot = 0;
    float filterRadius = 0; ///< of the sources, Light::filterRadius; 0 for all if no surface blurs light
    std::vector<Lanes3> color, direction;
    std::vector<ChannelLanes> channels;
};

/// All sums of a raw lightmap.
struct LuxelSums {
    std::vector<LuxelSum> sums;
    bool deluxe = false, directional = false;
    std::size_t used = 0; ///< how many of `sums` hold values; the rest only keep their memory

    void Clear() { used = 0; }
    /// The sum of that slot and filter radius; a new one is zero.
    LuxelSum &FindOrAdd(std::size_t slot, float filterRadius, std::size_t blocks);
};

/// Light of one source at the receivers of a block; zero where none arrives.
struct LuxelIncidentLight {
    Lanes3 color{};
    Lanes3 direction{}; ///< unit vector to the source times the luminance of its light here; 0 unless deluxe
    LaneMask lit{};
    LaneMask filtered{}; ///< lit through a transparent surface, by more than 1 (byte scale, before color)
};

/// Settings of a pass over one raw lightmap.
struct LuxelPass {
    SurfaceLightSettings settings;
    bool bounce = false, deluxe = false;
    DirectionalChannels channels;
};

/// Receivers of a block and the basis normals of their luxels, null without basis channels.
struct LuxelReceivers {
    SurfaceReceiverBatch &batch;
    const BasisLanes *basis = nullptr;
};

/// Sets the light of a group on a block from what arrives there.
void SetLuxelLight(const LightGroup &group, const LuxelPass &pass, const BasisLanes *basis,
                   const SurfaceIncidentLight &incident, LuxelIncidentLight &out, ChannelLanes &channels);

/// Evaluates a group at a block of receivers. False: no light arrives, and `out` and `channels` are not set.
bool LuxelContribution(const LightGroup &group, const LuxelPass &pass, const LightScene &scene,
                       const LuxelReceivers &receivers, LuxelIncidentLight &out, ChannelLanes &channels,
                       ContributionCounts &counts);

} // namespace q3
