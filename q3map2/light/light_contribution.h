// GPL-2.0-or-later. Where a light, points and the scene meet: one place for both light grids.
#pragma once

#include "libs/sh/sh.h"
#include "q3map2/light/light_scene.h"
#include "q3map2/light/light_sources.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace q3 {

/// Counts of work done and left out, one per worker; added up for the log.
struct ContributionCounts : RayCounts {
    std::uint64_t pairs = 0;         ///< light and point pairs looked at
    std::uint64_t skippedFacing = 0; ///< pairs behind an emitter, outside a cone or beyond the reach
    std::uint64_t skippedPvs = 0;    ///< pairs that cannot see each other by the visibility lump
    std::uint64_t skippedFaint = 0;  ///< pairs with an area light so faint that others stand for it
    std::uint64_t refined = 0;       ///< pairs with an area light partly hidden, traced with many rays
    ContributionCounts &operator+=(const ContributionCounts &o) {
        rays += o.rays, pairs += o.pairs, skippedFacing += o.skippedFacing, skippedPvs += o.skippedPvs;
        skippedFaint += o.skippedFaint, refined += o.refined;
        return *this;
    }
};

/// A place in the open that gets light.
struct LightPlace {
    Vec3f position;
    Vec3f rayOrigin; ///< the same or a hair beside, clear of solids
    int cluster = kSolidCluster;
    std::uint32_t index = 0; ///< of the grid point: seeds its sample patterns
    bool skip = false;       ///< leave this one out
    float collected = 0;     ///< faint light that waits to be represented; see ContributionSettings::faint
};

/// Light of one source that arrives at one place.
struct Arrival {
    std::uint32_t place = 0;      ///< index into the places
    float weight = 1;             ///< multiplies add: it stands for fainter lights too
    float add = 0;                ///< light of full colour, byte scale, unshadowed, > 0
    Vec3f direction;              ///< unit, to the light
    Vec3f visible;                ///< share that gets through, per channel
    std::array<float, 9> moments; ///< GridSH: projection of what arrives before `visible` colours it, cosine-convolved
                                  ///< unless radiance, byte scale, for a light of colour 1 1 1
};

/// Settings of a pass that are the same for all lights and places.
struct ContributionSettings {
    LightPass pass = LightPass::LegacyGrid;
    bool sunOnly = false;
    bool pointAreas = false; ///< -faster: area lights of the legacy grid by distance alone
    bool ignorePvs = false;  ///< let rays alone decide what sees what
    /// Byte scale. Area lights that give a place less are represented by a few: going through them in order, every time
    /// what they give adds up to this, one is taken, with the weight that makes up for the others. 0 takes every light.
    float faint = 0;
    bool exactAreas = false; ///< no approximations for faint and far area lights
    bool radiance = false;   ///< GridSH: plain projection, not convolved with the cosine
};

/// Sets `arrivals` to what `light`, times `weight`, gives to the places: falloff, cones, form factors, sides,
/// visibility by PVS and by ray. Neighbouring places should be neighbours in the list. LegacyGrid follows the
/// established program (one ray toward the light's centre, form factor toward it); GridSH is exact: every moment of an
/// area light in closed form, its visibility by sampling where it is partly hidden. Area lights that are faint or far
/// are approximated by less than 1/256 of a byte, and the faintest judged by one ray each. Safe from several threads.
void LightContributionToPoint(const Light &light, float weight, const ContributionSettings &settings,
                              const LightScene &scene, std::span<LightPlace> places, std::vector<Arrival> &arrivals,
                              ContributionCounts &counts);

/// Whether a light that gives `add` at the place is taken, and its new weight. See ContributionSettings::faint.
inline bool TakeFaint(float faint, float add, LightPlace &place, float &weight) {
    const float light = add * weight;
    if (light >= faint)
        return true;
    place.collected += light;
    if (place.collected < faint)
        return false;
    place.collected -= faint;
    weight = faint / add;
    return true;
}

/// Upper bound of what the light can give to any point of the box, byte scale times its colour's largest component.
float LightBound(const Light &light, const Boundsf &box);

} // namespace q3
