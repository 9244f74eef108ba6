// GPL-2.0-or-later. Light of one source at luxels and vertices.
#pragma once

#include "q3map2/light/batch/incident_light.h"
#include "q3map2/light/batch/receivers.h"
#include "q3map2/light/scene/light_scene.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/light/transfer/contribution_counts.h"

namespace q3 {

/// Settings of a pass over surfaces.
struct SurfaceLightSettings {
    bool sunOnly = false;
    bool pointAreas = false;  ///< -faster: area lights as points with two cosines
    bool halfLambert = false; ///< -lightanglehl: light wraps around
    bool occlusion = true;    ///< rays are traced
    bool sunOcclusion = true; ///< for suns too
    int receiveShadows = 1;   ///< shadow group of the surface; 0: nothing shadows it
    float faint = 0;          ///< as LightSettings::faint
    int ignoredProp = -1;     ///< static prop that does not shadow the receivers; -1: none
    bool directional = false; ///< SurfaceIncidentLight::directions are wanted

    /// Whether rays are traced for the light.
    bool Occludes(const Light &light) const {
        return occlusion && receiveShadows != 0 && (sunOcclusion || light.type != LightType::Sun);
    }
};

/// Sets `incident` to the light of `light`, prepared by SetupEnvelopes for surfaces, at receivers on surfaces: falloff,
/// cones, form factors, sides, angles, visibility by PVS and by one ray each; with settings.directional also its
/// directions. Safe from several threads.
void LightContributionToSample(const Light &light, const SurfaceLightSettings &settings, const LightScene &scene,
                               SurfaceReceiverBatch &receivers, SurfaceIncidentLight &incident,
                               ContributionCounts &counts);

} // namespace q3
