// GPL-2.0-or-later. Light of one source at luxels and vertices, and the directions that it comes from.
#pragma once

#include "q3map2/light/batch/receivers.h"
#include "q3map2/light/scene/light_scene.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/light/transfer/light_kernel.h"

#include <span>
#include <vector>

namespace q3 {

/// Settings of a pass over surfaces.
struct SurfaceLightSettings {
    bool sunOnly = false;     ///< -sunonly: other lights than suns give nothing
    bool pointAreas = false;  ///< -faster: area lights as points with two cosines
    bool halfLambert = false; ///< -lightanglehl: light wraps around
    bool shadows = true;      ///< shadow rays are traced
    bool sunShadows = true;   ///< for suns too
    int receiveShadows = 1;   ///< shadow group of the surface; 0: nothing shadows it
    float faint = 0;          ///< as LightSettings::faint
    int ignoredProp = -1;     ///< static prop that does not shadow the receivers; -1: none
    bool directional = false; ///< SurfaceIncidentLight::directions are wanted
    int areaShadows = 0;      ///< -areashadows: most rays of a receiver to an area light; 0: one, to its origin

    /// Whether area lights have soft shadows.
    bool HasSoftShadows() const { return areaShadows > 0 && !pointAreas; }
    /// Whether shadow rays are traced for the light.
    bool TracesShadowsOf(const Light &light) const {
        return shadows && receiveShadows != 0 && (sunShadows || light.type != LightType::Sun);
    }
};

/// Lights that light surfaces together: one, or with soft shadows all samples of one (Light::group).
class LightGroup {
  public:
    explicit LightGroup(std::span<const Light *const> samples);
    const Light &First() const { return *samples_.front(); }
    std::span<const Light *const> Samples() const { return samples_; }
    /// By which incident light is multiplied: the mean color of the samples.
    const Vec3f &Color() const { return color_; }
    bool ColorsDiffer() const { return colorsDiffer_; }

  private:
    std::span<const Light *const> samples_;
    Vec3f color_;
    bool colorsDiffer_ = false;
};

/// The groups of a list of lights, in its order.
std::vector<LightGroup> LightGroupsOf(std::span<const Light *const> lights, const SurfaceLightSettings &settings);

/// LightContributionToSample for a group; if it has more than one sample, its light is that of SoftSampledLight.
void GroupContributionToSample(const LightGroup &group, const SurfaceLightSettings &settings, const LightScene &scene,
                               SurfaceReceiverBatch &receivers, SurfaceIncidentLight &incident,
                               ContributionCounts &counts);

/// Sets `incident` to the light of `light`, prepared by SetupEnvelopes for surfaces, at receivers on surfaces: falloff,
/// cones, form factors, sides, angles, visibility by PVS and by one ray each; with settings.directional also its
/// directions. Safe from several threads.
void LightContributionToSample(const Light &light, const SurfaceLightSettings &settings, const LightScene &scene,
                               SurfaceReceiverBatch &receivers, SurfaceIncidentLight &incident,
                               ContributionCounts &counts);

/// Sets incident.directions of live receivers.
///
/// Point lights and suns: let C be the cosine at the receiver, A the factor for the angle of incidence, and L(A) the
/// light. `vector` points to the light; its length is min(L(1), L(A) / C) / L(A). `uniform` is the rest of the light on
/// the receiver's normal: half-Lambert light, lights without angle attenuation. Area lights: FormFactorVectors, with
/// the fluence of a cone that has the same irradiance vector, exact for disks seen from their axis. Light from behind a
/// two-sided receiver, and from the back of a two-sided area light unless `pointAreas`, is uniform.
///
/// pointAreas: area lights count as points (-faster). cosine, angleFactor: C and A, not used for area lights.
void SetLightDirections(const Light &light, bool pointAreas, const SurfaceReceiverBatch &receivers, const Lanes &cosine,
                        const Lanes &angleFactor, SurfaceIncidentLight &incident);

} // namespace q3
