// GPL-2.0-or-later. Solves for the radiosity of a map.
#pragma once

#include "q3map2/lightmap/bounce/bounce_gather.h"
#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// When the solver stops.
struct RadiosityLimits {
    int bounces = 1;    ///< number of bounces; kEndlessBounces: no limit
    double seconds = 0; ///< wall time; 0: no limit
    /// Stops when all later bounces together give less light than this anywhere, or, in dim maps, less than a small
    /// fraction of the mean light. Byte scale.
    float leastLight = 0.25;
};

struct RadiositySolution {
    Emission total;        ///< radiosity, summed over bounces
    int steps = 0;         ///< of the solver; without -bounce inf one for each bounce after the first
    float stillToCome = 0; ///< estimate of the most light that later bounces give anywhere, byte scale
    bool timedOut = false; ///< later bounces are not in `total`; else their estimate is
};

/// Radiosity equation B = B_1 + R K B over emitters: K is the transport along the kept gather rays, times dirt, R the
/// reflectance. A step shoots radiosity that was not shot before: either all of it, so that step k computes bounce
/// k + 1 (Jacobi iteration), or, under endless bounces, only the brightest groups of emitters, if these give more light
/// per ray (progressive refinement, Cohen et al., 1988). Only groups that see a shot group gather. The sum is a valid
/// result after each step. When the solver stops because little light is left, it adds an estimate of that light: the
/// rest of a geometric series. Const after construction.
class RadiositySolver {
  public:
    /// Keeps references.
    RadiositySolver(const SurfaceInputs &in, const SurfaceLight &surfaces, const EmitterIndex &emitters,
                    const BounceScene &scene, const BounceGather &gather);

    /// first: radiosity of the first bounce. Prints a line for each step.
    RadiositySolution Solve(Emission first, const RadiosityLimits &limits) const;

  private:
    /// Emitters that are shot and gathered together: the texels of a raw lightmap, or the vertices of a surface.
    struct Group {
        enum class Kind { Texels, Vertices };
        Group(Kind what, EmitterId firstEmitter, EmitterId emitters, std::size_t index)
            : kind(what), first(firstEmitter), count(emitters), number(index) {}
        Kind kind;
        EmitterId first, count;
        std::size_t number;                ///< of the raw lightmap or draw surface
        std::vector<EmitterId> vertexHits; ///< kSolverVertexRays for each vertex
        std::vector<float> dirt;           ///< by texel; empty: 1
        LuxelMask mapped;                  ///< by texel: whether it has a mapped luxel
        std::vector<std::uint32_t> sees;   ///< groups that its rays hit, ascending
        std::uint64_t rays = 0;

        std::span<Vec3f> Of(std::vector<Vec3f> &emitters) const { return std::span(emitters).subspan(first, count); }
        std::span<const Vec3f> Of(const std::vector<Vec3f> &emitters) const {
            return std::span(emitters).subspan(first, count);
        }
    };
    /// By group: not 0 if the group is shot.
    using GroupMask = std::vector<std::uint8_t>;
    struct State;

    void AddGroups();
    void FindRays(Group &group, const std::vector<std::uint32_t> &groupOf) const;
    bool SeesAny(const Group &group, const GroupMask &shot) const;
    GroupMask Brightest(const State &state) const;
    void GatherGroup(const Group &group, const Emission &shot, std::span<Vec3f> light) const;
    void FinishLight(const Group &group, std::span<Vec3f> light) const;
    void Step(const GroupMask &shot, State &state) const;
    void AddRest(int bounces, float peakDecay, State &state) const;

    const SurfaceInputs &in_;
    const SurfaceLight &surfaces_;
    const EmitterIndex &emitters_;
    const std::vector<Vec3f> &reflectance_;
    const BounceGather &gather_;
    std::vector<Group> groups_;
    std::uint64_t rays_ = 0; // sum over all groups
    float maxReflectance_ = 0;
};

} // namespace q3
