// GPL-2.0-or-later. The surfaces that reflect bounced light, as a scene for gather rays.
#pragma once

#include "q3map2/light/batch/receivers.h"
#include "q3map2/lightmap/raw/luxel_raster.h"

#include <memory>

namespace q3 {

/// Index of an emitter: a texel of a raw lightmap, or a draw vertex of a surface without lightmap.
using EmitterId = std::uint32_t;
inline constexpr EmitterId kNoEmitter = ~EmitterId(0);
/// Stands for the back of a one-sided surface as the first hit of a ray.
inline constexpr EmitterId kBackOfSurface = kNoEmitter - 1;
inline bool Emits(EmitterId id) {
    return id < kBackOfSurface;
}

/// Length of unbounded rays: longer than any map. Game units.
inline constexpr float kRayLength = 1e6f;

/// Assigns EmitterIds: first to the texels of all raw lightmaps (without supersampling), then to all draw vertices.
class EmitterIndex {
  public:
    explicit EmitterIndex(const SurfaceLight &surfaces);
    EmitterId Texel(std::size_t lightmap, int x, int y) const {
        return first_[lightmap] + EmitterId(y * widths_[lightmap] + x);
    }
    EmitterId FirstOf(std::size_t lightmap) const { return first_[lightmap]; }
    EmitterId Vertex(int vertex) const { return first_.back() + EmitterId(vertex); }
    std::size_t Count() const { return count_; }

  private:
    std::vector<EmitterId> first_; // by raw lightmap: id of its first texel; the last entry: id of the first vertex
    std::vector<int> widths_;
    std::size_t count_ = 0;
};

/// Whether gather rays can hit the surface: false for skies, translucent, undrawn and autosprite surfaces.
bool IsInBounceScene(const SurfaceInputs &in, std::size_t surface);
/// Limit on reflectance, so that the sum over bounces converges.
inline constexpr float kMaxReflectance = 0.99f;
/// Ratio of radiosity to received light for a white texture: q3map_bounce * LightmapOptions::bounceScale
/// (0.25 * -bouncescale) times 187.5 * 3 / 255, or times 4 with -reflectivity linear.
float BounceScale(const SurfaceInputs &in, std::size_t surface);

/// Drawn surfaces as an Embree scene. Solids are not in it: their visible sides are drawn surfaces. Const after
/// construction; safe from several threads.
class BounceScene {
  public:
    BounceScene(const SurfaceInputs &in, const SurfaceLight &surfaces, const EmitterIndex &emitters);
    ~BounceScene();

    /// The emitter at the first hit of each live ray; kBackOfSurface for backs of one-sided surfaces, kNoEmitter for
    /// misses and for surfaces that reflect nothing.
    std::array<EmitterId, kPacketSize> FirstEmitters(const RayPacket &rays, RayCoherence coherence) const;
    /// Clears the live lanes of rays that meet a surface within their distance, from either side.
    void TraceOccluded(RayPacket &rays) const;
    /// By emitter and channel: color of the texture at the emitter times BounceScale, at most kMaxReflectance.
    const std::vector<Vec3f> &Reflectance() const { return reflectance_; }

  private:
    struct State;
    void FindReflectance(const SurfaceInputs &in, const SurfaceLight &surfaces, const EmitterIndex &emitters);

    std::unique_ptr<State> state_;
    std::vector<Vec3f> reflectance_;
};

} // namespace q3
