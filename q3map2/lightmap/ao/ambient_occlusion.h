// GPL-2.0-or-later. Ambient occlusion at receivers on surfaces: dirt, the sky visibility of floodlight, the open sky.
#pragma once

#include "q3map2/lightmap/ao/near_triangles.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <vector>

namespace q3 {

/// Up to 16 neighboring receivers.
struct OcclusionReceivers {
    std::size_t count = 0;
    Lanes3 position{}, normal{};
    std::array<std::uint32_t, kPacketSize> seed{}; ///< of directions under -dirtmode 1
    int receiveShadows = 1;                        ///< shadow group; 0: nothing occludes them
    std::span<const int> surfaces;                 ///< draw surfaces that hold the receivers
    bool atVertices = false;                       ///< at vertices, not lifted off their surface

    void Add(const Vec3f &at, const Vec3f &n, std::uint32_t number) {
        position.Set(count, at), normal.Set(count, n);
        seed[count++] = number;
    }
};

/// Estimates occlusion by rays over the hemisphere. Const after construction; safe from several threads.
class AmbientOcclusion {
  public:
    explicit AmbientOcclusion(const SurfaceInputs &in);

    /// Factor of light: 1 - min(1, dirtScale * o^dirtGain), where o is the mean over rays of the fraction of the ray,
    /// dirtDepth long, that is behind its first hit. Fastest if the blocks are near each other.
    void Dirt(std::span<const OcclusionReceivers> blocks, std::vector<Lanes> &dirt, RayCounts &counts) const;
    /// Takes one ray of each receiver. visibility: fraction of the ray before its first hit, divided by the number of
    /// rays.
    using UseSkyRay = std::function<void(const Lanes3 &direction, const Lanes &visibility)>;
    /// Mean over rays, `distance` long, of the fraction of the ray before its first hit: 0 to 1. useRay, unless empty,
    /// is called with each ray.
    void SkyVisibility(const OcclusionReceivers &receivers, float distance, Lanes &visibility, RayCounts &counts,
                       const UseSkyRay &useRay = {}) const;

    /// Mean direction of the rays over the hemisphere that reach a sky; its length is the fraction of rays that do.
    /// Light absorbed by see-through surfaces counts as occluded.
    void OpenSky(const OcclusionReceivers &receivers, Lanes3 &sky, RayCounts &counts) const;

  private:
    /// Blockers around a block of receivers.
    struct Nearby {
        NearTriangles solids, surfaces;
        Boundsf rayBounds; ///< of the rays being traced
    };
    /// Which hits close to a receiver count.
    struct NearHitRules {
        LightScene::BlockerKind solids; ///< which solids block
        float minDistance;              ///< hits on surfaces nearer than this do not count
        float ownSurface;               ///< nor hits on the receivers' own surfaces nearer than this
    };
    struct BlockerTracer;
    /// All blockers of the map, for dirt of luxels; made at the first call.
    const Nearby &AllBlockers() const;
    void Dirt(const OcclusionReceivers &receivers, Nearby *nearby, Lanes &dirt, RayCounts &counts) const;
    /// Adds to `occlusion` the fraction of each live ray behind its first hit on a solid or, if it hits none, on a
    /// surface. nearby: all blockers that rays can hit; null: the scene is traced.
    void AccumulateOcclusion(const OcclusionReceivers &receivers, const RayPacket &rays, const NearHitRules &rules,
                             Nearby *nearby, Lanes &occlusion, RayCounts &counts) const;

    const LightScene &scene_;
    const BspSpace &space_;
    float depth_, scale_, gain_;
    bool random_;
    std::vector<Vec3f> dirtDirections_, floodDirections_; ///< in tangent frames
    mutable std::once_flag allBlockersMade_;
    mutable Nearby allBlockers_; ///< see AllBlockers
};

/// Indices in the super grid.
using LuxelIndices = std::array<std::uint32_t, kPacketSize>;

/// Calls batch(lightmap, blocks, luxels, worker) for all mapped luxels of the raw lightmaps for which wants() is true,
/// many blocks of 16 neighbors at a time, on the workers of in.jobs. luxels: by block, the luxel of each receiver.
using LuxelBatchFunction = std::function<void(RawLightmap &, std::span<const OcclusionReceivers>,
                                              std::span<const LuxelIndices>, std::size_t worker)>;
void ForMappedLuxelBatches(const SurfaceInputs &in, SurfaceLight &surfaces,
                           const std::function<bool(const RawLightmap &)> &wants, const LuxelBatchFunction &batch);

} // namespace q3
