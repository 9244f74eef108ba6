// GPL-2.0-or-later. Terms of the photometric model that grids and surfaces share.
#pragma once

#include "q3map2/light/transfer/light_contribution.h"

#include <cmath>

namespace q3 {

/// No light is stronger than at this distance. Game units.
inline constexpr float kNearest = 16;
inline constexpr float kLinearScale = 1.0f / 8000;
/// A spotlight fades over this much at the rim of its cone. Game units.
inline constexpr float kConeFade = 32;
/// Area lights are evaluated from at least this far in front by the established program's formula. Game units.
inline constexpr float kAreaPush = 8;

/// Share of a spotlight that its cone leaves along `toLight` (not normalised).
inline float ConeShare(const Light &light, const Vec3f &toLight) {
    const float along = -Dot(toLight, light.normal);
    if (along < 0)
        return 0;
    const float coneRadius = light.radiusByDist * along;
    const float off = Length(-toLight - light.normal * along);
    if (off >= coneRadius)
        return 0;
    return off > coneRadius - kConeFade ? (coneRadius - off) / kConeFade : 1;
}

/// Wanted receivers (ReceiverBatch or SurfaceReceiverBatch) that may see the light; counts pairs.
template <typename Receivers>
LaneMask InSight(const Light &light, bool skipPvs, const Receivers &receivers, ContributionCounts &counts) {
    LaneMask live = receivers.wanted;
    const int wanted = live.Count();
    counts.pairs += std::uint64_t(wanted);
    if (!skipPvs || light.seenFrom.empty())
        return live;
    unsigned seen = 0;
    for (std::size_t i = 0; i < receivers.clusters.count; ++i)
        seen |= light.SeenFrom(receivers.clusters.number[i]) ? receivers.clusters.lanes[i] : 0;
    live.Keep(seen);
    counts.skippedPvs += std::uint64_t(wanted - live.Count());
    return live;
}

} // namespace q3
