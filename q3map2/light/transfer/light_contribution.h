// GPL-2.0-or-later. Where a light, receivers and the scene meet: one place for both light grids and for surfaces.
#pragma once

#include "libs/sh/sh.h"
#include "q3map2/light/scene/light_scene.h"
#include "q3map2/light/sources/light_sources.h"

#include <array>
#include <cstdint>
#include <span>

namespace q3 {

/// Counts of work done and left out, one per worker; added up for the log.
struct ContributionCounts : RayCounts {
    std::uint64_t pairs = 0;          ///< pairs of light and place looked at
    std::uint64_t skippedFacing = 0;  ///< pairs behind an emitter, outside a cone or beyond the reach
    std::uint64_t skippedPvs = 0;     ///< pairs that cannot see each other by the visibility lump
    std::uint64_t skippedFaint = 0;   ///< pairs with a light so faint that others stand for it
    std::uint64_t skippedMoments = 0; ///< pairs whose moments a point or a few samples stand for
    std::uint64_t skippedProbes = 0;  ///< pairs with a faint area light, judged by one ray
    std::uint64_t skippedCoarse = 0;  ///< pairs whose visibility coarse neighbours tell
    std::uint64_t refined = 0;        ///< pairs with an area light partly hidden, traced with many rays
    ContributionCounts &operator+=(const ContributionCounts &o);
};

/// Up to 16 neighbouring receivers in the open that get light.
struct ReceiverBatch {
    std::size_t count = 0;
    Lanes3 position{}, rayOrigin{}; ///< rays start at the position or a hair beside, clear of solids
    LaneClusters clusters;
    std::array<std::uint32_t, kPacketSize> index{}; ///< of the grid point: seeds its sample patterns
    LaneMask wanted{};                              ///< receivers that take (more) light
    Boundsf rayOrigins;                             ///< of all receivers
    float faintResidual = 0; ///< faint light that waits to be represented; see LightSettings::faint

    void Add(const Vec3f &at, const Vec3f &raysFrom, int clusterAt, std::uint32_t indexAt);
};

/// Light of one source that arrives at receivers.
struct IncidentLight {
    LaneMask live{};     ///< receivers that get any; the others' numbers mean nothing
    Lanes add;           ///< light of full colour, byte scale, unshadowed, > 0
    Lanes3 direction;    ///< unit, to the light; zero in it
    Lanes distance;      ///< of the rays there
    bool tinted = false; ///< by coloured surfaces on the way
    Lanes3 tint;         ///< if so
    /// GridSH: projection of what arrives, before the tint, cosine-convolved unless radiance, byte scale, for a light
    /// of colour 1 1 1. Zero where nothing arrives.
    std::array<Lanes, 9> shCoeffs;
};

/// Settings of a pass that are the same for all lights and receivers.
struct LightSettings {
    LightPass pass = LightPass::LegacyGrid;
    bool sunOnly = false;
    bool pointAreas = false; ///< -faster: area lights of the legacy grid by distance alone
    bool radiance = false;   ///< GridSH: plain projection, not convolved with the cosine
    float samples = 1;       ///< factor of the number of rays to partly hidden area lights
    SkipOptions skip;
    /// Byte scale. Area lights that give a block of receivers less are represented by a few: going through them in
    /// order, every time what they give adds up to this, one is taken, with the weight that makes up for the others. 0
    /// takes every light.
    float faint = 0;
};

/// Sets incident[i] to what `light`, times `weight`, gives to blocks[i]: falloff, cones, form factors, sides,
/// visibility by PVS and by ray. No live receivers: nothing to any. LegacyGrid follows the established program (one ray
/// toward the light's centre, form factor toward it); GridSH is exact: every moment of an area light in closed form,
/// its visibility by sampling where it is partly hidden. Area lights that are faint or far are approximated by less
/// than 1/256 of a byte, and the faintest judged by one ray each. Where a dim light is seen alike from a few receivers
/// of a block, the others are taken to see it alike. Safe from several threads.
void LightContributionToPoint(const Light &light, float weight, const LightSettings &settings, const LightScene &scene,
                              std::span<ReceiverBatch> blocks, std::span<IncidentLight> incident,
                              ContributionCounts &counts);

/// Up to 16 neighbouring receivers on surfaces that get light: luxels or vertices.
struct SurfaceReceiverBatch {
    std::size_t count = 0;
    Lanes3 position{}, normal{}; ///< normals are units
    LaneClusters clusters;
    LaneMask wanted{};       ///< receivers that take light
    bool twoSided = false;   ///< light from behind counts too
    float faintResidual = 0; ///< faint light that waits to be represented; see SurfaceLightSettings::faint

    void Add(const Vec3f &at, const Vec3f &normalAt, int clusterAt);
};

/// Light of one source that arrives at receivers on surfaces: colour of the light times add times tint.
struct SurfaceIncidentLight {
    LaneMask live{};       ///< receivers that get any; the others' numbers mean nothing
    Lanes add;             ///< light of full colour, byte scale, > 0
    Lanes3 direction;      ///< unit, to the light; zero in it
    Lanes distance;        ///< of the rays there
    LaneMask undirected{}; ///< lit from behind: nothing for direction maps
    LaneMask filtered{};   ///< the ray went through a see-through surface, or ended at one
    bool tinted = false;   ///< by coloured surfaces on the way
    Lanes3 tint;           ///< if so
};

/// Settings of a pass over surfaces.
struct SurfaceLightSettings {
    bool sunOnly = false;
    bool pointAreas = false;  ///< -faster: area lights as points with two cosines
    bool halfLambert = false; ///< -lightanglehl: light wraps around
    bool occlusion = true;    ///< rays are traced
    bool sunOcclusion = true; ///< for suns too
    int receiveShadows = 1;   ///< shadow group of the surface; 0: nothing shadows it
    float faint = 0;          ///< as LightSettings::faint, by SurfaceReceiverBatch::faintResidual

    /// Whether rays are traced for the light.
    bool Occludes(const Light &light) const {
        return occlusion && receiveShadows != 0 && (sunOcclusion || light.type != LightType::Sun);
    }
};

/// Sets `incident` to what `light`, prepared by SetupEnvelopes for surfaces, gives to receivers on surfaces: falloff,
/// cones, form factors, sides, angles, visibility by PVS and by one ray each. Safe from several threads.
void LightContributionToSample(const Light &light, const SurfaceLightSettings &settings, const LightScene &scene,
                               SurfaceReceiverBatch &samples, SurfaceIncidentLight &incident,
                               ContributionCounts &counts);

/// Whether a light that gives at most `strongest` is taken, and its new weight. See LightSettings::faint.
bool SelectFaintLight(float faint, float strongest, float &faintResidual, float &weight);
inline bool SelectFaintLight(float faint, float strongest, ReceiverBatch &receivers, float &weight) {
    return SelectFaintLight(faint, strongest, receivers.faintResidual, weight);
}

/// Upper bound of what the light can give to any point of the box, byte scale times its colour's largest component.
float LightBound(const Light &light, const Boundsf &box);

} // namespace q3
