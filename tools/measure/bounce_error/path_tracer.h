// GPL-2.0-or-later. Path tracer: the reference for the light stage's bounced light.
//
// Light at a receiver is the mean over paths. The first direction of a path has the density cosine / pi (luxels) or is
// uniform over the sphere (positions of the light grids). At each surface its throughput is multiplied by the
// reflectance of the texel, and direct light of one source, chosen by importance and tested by a shadow ray, is added
// (next event estimation); then it continues in a direction of density cosine / pi. From the third surface on it
// survives with probability p = min(0.95, largest channel of the throughput), which is divided by p (Russian roulette).
// Nothing is stored by texel and nothing is filtered, so the only error is noise.
//
// Direct light follows the light stage's first pass, as if a luxel were at the hit: style 0, its rules for angles and
// sides, one shadow ray to the center of an area light, ambient light. Left out: dirt, floodlight, blur over luxels
// (-filter, q3map_lightmapFilterRadius), samples within a luxel, the clamp of negative sums.
#pragma once

#include "tools/measure/bounce_error/direct_light.h"
#include "tools/measure/bounce_error/path_scene.h"

#include <array>
#include <span>
#include <vector>

namespace q3::bounce {

/// Numbers of bounces for which a result is kept; 0: all bounces.
inline constexpr std::array<int, 10> kBounceLimits{1, 2, 3, 4, 5, 6, 8, 12, 16, 0};
inline constexpr std::size_t kAllBounces = kBounceLimits.size() - 1;
/// Index in kBounceLimits of a number of bounces; kAllBounces below 1 and above the largest. Error: a number between
/// two entries.
std::size_t LimitIndexOf(int bounces);

/// Paths are traced in groups of this many. The spread of group means gives the standard error.
inline constexpr int kPathGroup = 256;

/// Bounced light for each of kBounceLimits. Byte scale.
struct Estimate {
    std::array<Vec3f, kBounceLimits.size()> light{}, error{}; ///< mean and its standard error
    bool operator==(const Estimate &) const = default;
};

/// Traces paths. Const after construction; safe from several threads, and results do not depend on them.
class PathTracer {
  public:
    /// Keeps references. `surfaces` may be in the state before the first pass.
    PathTracer(const SurfaceInputs &in, const SurfaceLight &surfaces, const DirectLights &lights)
        : in_(in), scene_(in, surfaces), lights_(lights) {}

    /// Light on a surface with that normal, mean over `positions`. paths: total, rounded up to whole groups; the error
    /// is 0 with a single group.
    Estimate OnSurface(std::span<const Vec3f> positions, const Vec3f &normal, int paths, std::uint64_t seed) const;
    /// Light on surfaces with each of `normals` at a position in the open, all from the same paths.
    std::vector<Estimate> InSpace(const Vec3f &position, std::span<const Vec3f> normals, int paths,
                                  std::uint64_t seed) const;

    /// The receiver at which direct light of a hit is evaluated.
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
