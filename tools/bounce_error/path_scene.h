// GPL-2.0-or-later. Surfaces that paths of bounced light meet.
#pragma once

#include "q3map2/light/batch/ray_packet.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <memory>
#include <optional>

namespace q3::bounce {

/// Greatest reflectance: BounceScale of a map may be above 1, with which light would never end.
inline constexpr float kMaxReflectance = 0.99f;

/// Where a path meets a surface that reflects.
struct PathHit {
    int surface = -1;
    Vec3f position;
    Vec3f front;                  ///< unit normal of the triangle, on the side that the ray came from
    Vec3f normal;                 ///< interpolated unit normal of the surface, on its front
    bool behind = false;          ///< the back of a two-sided surface was hit
    std::array<float, 2> luxel{}; ///< coordinates in the super grid of its raw lightmap
    std::array<float, 2> st{};    ///< texture coordinates
    int vertex = 0;               ///< nearest draw vertex
    Vec3f reflectance;            ///< 0 to kMaxReflectance
};

/// The drawn surfaces as an Embree scene of its own, with the texel of the full image as reflectance. Const after
/// construction; safe from several threads.
class PathScene {
  public:
    /// Keeps references. The images must be kept: ShaderLibrary::ReleaseImages(true).
    PathScene(const SurfaceInputs &in, const SurfaceLight &surfaces);
    ~PathScene();

    using Hits = std::array<std::optional<PathHit>, kPacketSize>;
    /// First hits of the live rays. None where a ray leaves the map or ends at the back of a one-sided surface or at
    /// one that reflects nothing. met: rays that meet any surface.
    void FirstHits(const RayPacket &rays, Hits &hits, LaneMask *met = nullptr) const;

    /// How many of the live rays first meet the back of a one-sided surface.
    int BacksMet(const RayPacket &rays) const;

    /// Reflectance of a surface at texture coordinates.
    Vec3f ReflectanceAt(std::size_t surface, const std::array<float, 2> &st) const;
    /// The same with the image averaged down to `side` texels a side at most.
    Vec3f MeanReflectanceAt(std::size_t surface, const std::array<float, 2> &st, int side) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace q3::bounce
