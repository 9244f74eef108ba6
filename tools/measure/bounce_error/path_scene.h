// GPL-2.0-or-later. The scene of surfaces that reflect paths of bounced light.
#pragma once

#include "q3map2/light/batch/receivers.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <memory>
#include <optional>

namespace q3::bounce {

/// The point where a path meets a reflecting surface.
struct PathHit {
    int surface = -1;
    Vec3f position;
    Vec3f facingNormal;           ///< unit normal of the triangle, on the side that the ray came from
    Vec3f normal;                 ///< interpolated unit normal of the surface, on its front
    bool behind = false;          ///< whether the ray hit the back of a two-sided surface
    std::array<float, 2> luxel{}; ///< coordinates among the luxels of its raw lightmap, supersampling included
    std::array<float, 2> st{};    ///< texture coordinates
    int vertex = 0;               ///< nearest draw vertex
    Vec3f reflectance;            ///< 0 to kMaxReflectance
};

/// The drawn surfaces as an Embree scene, independent of BounceScene; reflectance is taken from the texel of the full
/// image at a hit. Const after construction; safe from several threads.
class PathScene {
  public:
    /// Keeps references. Images must still be loaded: use ShaderLibrary::ReleaseImages(KeptImages::OfReflectors).
    PathScene(const SurfaceInputs &in, const SurfaceLight &surfaces);
    ~PathScene();

    using Hits = std::array<std::optional<PathHit>, kPacketSize>;
    /// First hits of the live rays. Empty where a ray leaves the map, or meets the back of a one-sided surface or a
    /// surface that reflects nothing. met: set to the rays that meet any surface.
    void FirstHits(const RayPacket &rays, Hits &hits, LaneMask *met = nullptr) const;

    /// Number of live rays whose first hit is the back of a one-sided surface.
    int CountBackHits(const RayPacket &rays) const;

    /// Reflectance of a surface at texture coordinates.
    Vec3f ReflectanceAt(std::size_t surface, const std::array<float, 2> &st) const;
    /// The same with the image averaged down to at most `side` texels on a side, not limited to kMaxReflectance.
    Vec3f MeanReflectanceAt(std::size_t surface, const std::array<float, 2> &st, int side) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace q3::bounce
