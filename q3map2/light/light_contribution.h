// GPL-2.0-or-later. Where a light, points and the scene meet: one place for both light grids.
#pragma once

#include "libs/sh/sh.h"
#include "q3map2/light/light_scene.h"
#include "q3map2/light/light_sources.h"

#include <array>
#include <cstdint>

namespace q3 {

/// Counts of work done and left out, one per worker; added up for the log.
struct ContributionCounts : RayCounts {
    std::uint64_t pairs = 0;          ///< light and point pairs looked at
    std::uint64_t skippedFacing = 0;  ///< pairs behind an emitter, outside a cone or beyond the reach
    std::uint64_t skippedPvs = 0;     ///< pairs that cannot see each other by the visibility lump
    std::uint64_t refined = 0;        ///< pairs with an area light partly hidden, traced with many rays
    ContributionCounts &operator+=(const ContributionCounts &o) {
        rays += o.rays, pairs += o.pairs, skippedFacing += o.skippedFacing, skippedPvs += o.skippedPvs;
        refined += o.refined;
        return *this;
    }
};

/// Up to kPacketSize neighbouring grid points, and what one light gives to each.
struct PointPacket {
    int count = 0;
    // In.
    std::array<Vec3f, kPacketSize> position; ///< in the open
    std::array<Vec3f, kPacketSize> rayOrigin; ///< the same or a hair beside, clear of solids
    std::array<int, kPacketSize> cluster{};
    std::array<std::uint32_t, kPacketSize> index{}; ///< of the grid point: seeds its sample patterns
    std::array<bool, kPacketSize> skip{};           ///< leave this point out
    // Out, for points that get light; the others have add = 0.
    std::array<float, kPacketSize> add{};       ///< light of full colour at this point, byte scale, unshadowed, >= 0
    std::array<Vec3f, kPacketSize> direction;   ///< unit, to the light
    std::array<Vec3f, kPacketSize> visible;     ///< share that arrives, per channel; 0: hidden
    std::array<ShVector, kPacketSize> moments;  ///< GridSH: projection of what arrives, cosine-convolved unless radiance, byte
                                                ///< scale, for a light of colour 1 1 1
};

/// Settings of a pass that are the same for all lights and points.
struct ContributionSettings {
    LightPass pass = LightPass::LegacyGrid;
    bool sunOnly = false;
    bool pointAreas = false; ///< -faster: area lights of the legacy grid by distance alone
    bool ignorePvs = false;  ///< let rays alone decide what sees what
    bool radiance = false;   ///< GridSH: plain projection, not convolved with the cosine
};

/// Fills the outputs of `points` with what `light` gives them: falloff, cones, form factors, sides, visibility by PVS and by ray.
/// LegacyGrid follows the established program (one ray toward the light's centre, form factor toward it); GridSH is exact: every
/// moment of an area light in closed form, its visibility by sampling where it is partly hidden. Safe from several threads.
void LightContributionToPoint(const Light &light, const ContributionSettings &settings, const LightScene &scene,
                              PointPacket &points, ContributionCounts &counts);

/// Upper bound of what the light can give to any point of the box, byte scale times its colour's largest component.
float LightBound(const Light &light, const Boundsf &box);

} // namespace q3
