// GPL-2.0-or-later. Bounced light by path tracing: the reference for the light stage's bounces.
//
// Light at a receiver is the mean over paths. The first direction of a path has the density cosine / pi (luxels) or is
// uniform over the sphere (positions of the light grids). Where it meets a surface it is multiplied by the reflectance
// of the texel there, and the direct light on that point, of one source chosen by importance and seen by a shadow ray,
// is added (next event estimation); then it goes on in a direction of density cosine / pi. From the third surface on it
// survives with the probability min(0.95, largest channel) and grows accordingly (Russian roulette). Nothing is stored
// by texel and nothing is filtered, so the only error is noise.
//
// Direct light is that of the light stage's first pass at a luxel there: style 0, its angle and side rules, one shadow
// ray to the center of an area light, ambient light. Not in it: dirt, floodlight, blur over luxels (-filter,
// q3map_lightmapFilterRadius), samples within a luxel, the clamp of negative sums.
#pragma once

#include "tools/bounce_error/direct_light.h"
#include "tools/bounce_error/path_scene.h"

#include <array>
#include <span>
#include <vector>

namespace q3::bounce {

/// Numbers of bounces for which light is kept; 0: all.
inline constexpr std::array<int, 10> kLimits{1, 2, 3, 4, 5, 6, 8, 12, 16, 0};
inline constexpr std::size_t kAllBounces = kLimits.size() - 1;
/// The entry of kLimits for a number of bounces; above the last number, all. Error: it is between two entries.
std::size_t LimitOf(int bounces);

/// Paths are traced in groups of this many, whose means give the standard error.
inline constexpr int kPathGroup = 256;

/// Bounced light, by kLimits. Byte scale.
struct Estimate {
    std::array<Vec3f, kLimits.size()> light{}, error{}; ///< mean and its standard error
    bool operator==(const Estimate &) const = default;
};

/// Traces paths. Const after construction; safe from several threads, and results do not depend on them.
class PathTracer {
  public:
    /// Keeps references. `surfaces` needs only what is there before the first pass.
    PathTracer(const SurfaceInputs &in, const SurfaceLight &surfaces, const DirectLights &lights)
        : in_(in), scene_(in, surfaces), lights_(lights) {}

    /// On a surface of that normal, mean over `positions`. paths: in all, rounded up to groups; for an error there must
    /// be two.
    Estimate OnSurface(std::span<const Vec3f> positions, const Vec3f &normal, int paths, std::uint64_t seed) const;
    /// On surfaces of each of `normals` at a position in the open, from the same paths.
    std::vector<Estimate> InSpace(const Vec3f &position, std::span<const Vec3f> normals, int paths,
                                  std::uint64_t seed) const;

    /// The receiver of direct light at a hit.
    SurfacePoint ReceiverAt(const PathHit &hit) const;
    const PathScene &Scene() const { return scene_; }

  private:
    struct Path;
    class Group;
    const SurfaceInputs &in_;
    PathScene scene_;
    const DirectLights &lights_;
};

} // namespace q3::bounce
