// GPL-2.0-or-later. Steps from a light to receivers that grids, luxels and vertices share, and counts of that work.
#pragma once

#include "libs/math/elementary.h"
#include "q3map2/light/batch/receivers.h"
#include "q3map2/light/sources/light_sources.h"

#include <cmath>
#include <cstdint>

namespace q3 {

/// Pairs of a light and a receiver by outcome. Each worker has its own; they are summed for the log.
struct ContributionCounts : RayCounts {
    std::uint64_t pairs = 0;          ///< pairs considered
    std::uint64_t skippedUnlit = 0;   ///< behind an emitter, outside a cone or beyond the reach
    std::uint64_t skippedPvs = 0;     ///< hidden from each other by the visibility lump
    std::uint64_t skippedFaint = 0;   ///< with a light so faint that others represent it
    std::uint64_t skippedMoments = 0; ///< with an emitter approximated by a point or a few samples
    std::uint64_t skippedProbes = 0;  ///< with a faint area light, its visibility from one ray
    std::uint64_t skippedCoarse = 0;  ///< with visibility taken from other receivers of the batch
    std::uint64_t refined = 0;        ///< with an area light partly hidden, its visibility from many rays

    ContributionCounts &operator+=(const ContributionCounts &o) {
        rays += o.rays, pairs += o.pairs, skippedUnlit += o.skippedUnlit, skippedPvs += o.skippedPvs;
        skippedFaint += o.skippedFaint, skippedMoments += o.skippedMoments, skippedProbes += o.skippedProbes;
        skippedCoarse += o.skippedCoarse, refined += o.refined;
        return *this;
    }
};

/// Form factors of area lights are taken from at least this far in front of their plane, as in NetRadiant's q3map2.
/// Game units.
inline constexpr float kAreaPush = 8;
/// One-sided area lights do not light receivers farther than this behind their plane. Game units.
inline constexpr float kAreaBehind = 1;
/// Receivers within kAreaOwnSide (game units) of an area light's plane lie on its own surface if the cosine between the
/// normals is over kAreaOwnCosine.
inline constexpr float kAreaOwnSide = 3, kAreaOwnCosine = 0.9f;
/// SH grid: receivers nearer than this to an area light's plane get nothing from it. Soft shadows: so far behind the
/// plane of a one-sided light counts as in front. Game units.
inline constexpr float kPlaneClearance = 1.0f / 64;
/// Rays to points of an area light end this far in front of it, since its surface is in the scene, or half way to its
/// plane if that is nearer. Game units.
inline constexpr float kEmitterGap = 0.125f;

/// No point of an area light's polygon is farther from its origin. Game units.
inline float ReachOfPolygon(const Light &light) {
    return light.shape.radius + Length(light.shape.center - light.origin);
}

/// Number n of stratified rays to a partly hidden light for which the expected error of its light is `error`:
/// error = (light / 2) n^-0.75.
inline float RaysForShare(float light, float error) {
    return Pow(0.5f * light / error, 1 / 0.75f);
}

/// Wanted receivers that may see the light; with skipPvs, by visibility data. Counts pairs.
LaneMask InSight(const Light &light, bool skipPvs, const ReceiverBatch &receivers, ContributionCounts &counts);

/// Direction u and distance d of each receiver p to a target t, with D = t - p: d = |D|, u = D / d; u = 0 if d = 0.
void AimAt(const Vec3f &target, const Lanes3 &position, IncidentLight &incident);
/// Direction and distance of suns: the same for all receivers.
void AimAtSun(const Light &light, IncidentLight &incident);

/// Sets `strength` of point lights and spotlights: Falloff(distance, angleFactor) times ConeFraction. angleFactor: of
/// the angle of incidence.
void SetPointLight(const Light &light, const Lanes &angleFactor, IncidentLight &incident);

/// heights: signed, of each receiver over the plane of an area light; pushed: where its form factor is taken, moved
/// along the light's normal to kAreaPush over the plane if it is within kAreaPush of it. Game units.
void AreaHeights(const Light &light, const Lanes3 &position, Lanes &heights, Lanes3 &pushed);

/// Receivers that get at most the light's tolerance are live no longer; at most 0 unless it endsAtTolerance.
void CullBelowTolerance(const Light &light, IncidentLight &incident);
/// The greatest `strength` of a live receiver; 0 if there is none.
float Strongest(const IncidentLight &incident);
/// SelectFaintLight for area lights; multiplies `strength` by the weight of the light. False: not selected, and no
/// receiver stays live. Call only if a receiver is live.
bool ApplyFaintSelection(const Light &light, float faint, float weight, ReceiverBatch &receivers,
                         IncidentLight &incident, ContributionCounts &counts);

/// Shadow rays of the live receivers of a batch.
void SetShadowRays(const ReceiverBatch &receivers, const IncidentLight &incident, RayPacket &rays);
/// Receivers whose traced shadow ray was blocked are live no longer; the others get its tint.
void ApplyShadowRays(const RayPacket &rays, IncidentLight &incident);

} // namespace q3
