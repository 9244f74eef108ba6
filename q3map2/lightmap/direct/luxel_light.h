// GPL-2.0-or-later. Direct light on luxels: culling of lights, visibility of named lights, debug views.
#pragma once

#include "q3map2/light/sources/light_sources.h"
#include "q3map2/lightmap/direct/luxel_contribution.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <vector>

namespace q3 {

/// How a pass lights one raw lightmap.
LuxelPass LuxelPassOf(const SurfaceInputs &in, const SurfacePass &pass, const RawLightmap &lightmap);

/// The lights that may reach a raw lightmap: seen from one of its clusters, with the lightmap in their envelope, and on
/// the front side of a planar one. Reused from lightmap to lightmap.
class LuxelLightList {
  public:
    /// passLights: the lights of the pass, made with SunsSeen::Everywhere.
    void Build(const LightsByCluster &passLights, const RawLightmap &lightmap, const SurfaceLightSettings &settings);
    const std::vector<const Light *> &Lights() const { return list_; }

  private:
    std::vector<const Light *> list_;
};

/// Sets RawLightmap::visibility for each targetname in LightmapOptions::shadowMaps: arriving over unshadowed light,
/// summed over all lights of that name, such as the samples of one light. `lights`: from SetupEnvelopes for surfaces. A
/// name that no light has is a warning. Call before the last AverageLuxels.
void FindVisibility(const SurfaceInputs &in, const std::vector<Light> &lights, SurfaceLight &surfaces,
                    ContributionCounts &counts);

/// Overwrites the light of every mapped luxel, style slot 0, with the view. Does nothing for DebugView::Light.
void DrawDebugView(DebugView view, RawLightmap &lightmap);

/// Lights all mapped luxels by `lights` (from SetupEnvelopes for surfaces) and ambient light: sets light,
/// directional, filled, styles and directions. Adds the work done to `counts`.
void LightLuxels(const SurfaceInputs &in, const std::vector<Light> &lights, const SurfacePass &pass,
                 SurfaceLight &surfaces, ContributionCounts &counts);

} // namespace q3
