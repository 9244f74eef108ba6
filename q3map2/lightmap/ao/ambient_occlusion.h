// GPL-2.0-or-later. How open the surroundings of receivers on surfaces are: dirt and floodlight.
#pragma once

#include "q3map2/lightmap/ao/near_triangles.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <vector>

namespace q3 {

/// Up to 16 neighbouring receivers on surfaces.
struct OpenReceivers {
    std::size_t count = 0;
    Lanes3 position{}, normal{};
    std::array<std::uint32_t, kPacketSize> seed{}; ///< of random directions
    int receiveShadows = 1;
    std::span<const int> surfaces; ///< draw surfaces they are on
    bool vertices = false;         ///< receivers lie on their surfaces, and perhaps close under others

    void Add(const Vec3f &at, const Vec3f &n, std::uint32_t number) {
        position.Set(count, at), normal.Set(count, n);
        seed[count++] = number;
    }
};

/// Looks around receivers. Const after construction; safe from several threads.
class AmbientOcclusion {
  public:
    explicit AmbientOcclusion(const SurfaceInputs &in);

    /// 1 where nothing is near, down to 0 where the place is shut in. The blocks should be near each other.
    void Dirt(std::span<const OpenReceivers> blocks, std::vector<Lanes> &dirt, RayCounts &counts) const;
    /// Share of the hemisphere that is open within `distance`, 0 to 1.
    void SkyVisibility(const OpenReceivers &receivers, float distance, Lanes &open, RayCounts &counts) const;

  private:
    /// Triangles of both kinds around a block of receivers.
    struct Nearby {
        NearTriangles solids, surfaces;
        RayBeam beam; ///< that holds the rays being traced
    };
    /// How surfaces close to a place count.
    struct CloseRules {
        LightScene::BlockerKind solids; ///< which of them count
        float nearest;                  ///< no surface nearer than this does
        float ownSurface;               ///< those that the place is on do not when nearer than this
    };
    struct Walk;
    /// All that there are, for dirt of luxels; made when the first asks.
    const Nearby &All() const;
    void Dirt(const OpenReceivers &receivers, Nearby *nearby, Lanes &dirt, RayCounts &counts) const;
    /// Adds to `missing` the share of each live ray that lies behind what blocks it: a solid on its way, wherever that
    /// is, or else a surface. space: around the receivers. nearby: all that can block, or null.
    void Gather(const OpenReceivers &receivers, const RayPacket &rays, const CloseRules &rules, const BspRegion &space,
                Nearby *nearby, Lanes &missing, RayCounts &counts) const;

    const LightScene &scene_;
    const BspSpace &space_;
    float depth_, scale_, gain_;
    bool random_;
    std::vector<Vec3f> dirtDirections_, floodDirections_; ///< right, up, normal
    mutable std::once_flag allMade_;
    mutable Nearby all_; ///< see All
};

/// Numbers in the super grid.
using LuxelNumbers = std::array<std::uint32_t, kPacketSize>;

/// Calls look(lightmap, blocks, luxels, worker) for all mapped luxels of raw lightmaps that `wants` names, many blocks
/// of 16 neighbours at a time, on the workers of in.jobs. luxels: by block, the luxel of each place.
using LookAtLuxels = std::function<void(RawLightmap &, std::span<const OpenReceivers>, std::span<const LuxelNumbers>,
                                        std::size_t worker)>;
void ForMappedLuxels(const SurfaceInputs &in, SurfaceLight &surfaces,
                     const std::function<bool(const RawLightmap &)> &wants, const LookAtLuxels &look);

} // namespace q3
