// GPL-2.0-or-later. How far each light of a pass reaches.
#pragma once

#include "q3map2/light/options/light_options.h"
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/scene/surface_table.h"
#include "q3map2/light/sources/light_sources.h"

#include <vector>

namespace q3 {

/// How SetupEnvelopes bounds the lights of a pass.
enum class LightPass {
    LegacyGrid, ///< as the established program: entity lights, under -fast all, end at their tolerance; one cluster per
                ///< light
    GridSH,     ///< no tolerance; all clusters that an area light touches
    Surfaces ///< lightmaps and vertices: point lights and spots, under -fast all, end at their tolerance; one cluster
             ///< per light
};

/// Prepares lights for a pass: sign of negative lights, clusters, envelope, bounds. Lights in solid are nudged out, or
/// dropped. `culled`: number of all lights left out, also those not for this pass or without reach. Sorted by style.
/// skySeenFrom: see SkySeenFrom. fastPoint: in the Surfaces pass, point lights and spots end at their tolerance; false
/// under -nofastpoint.
std::vector<Light> SetupEnvelopes(std::vector<Light> lights, LightPass pass, const LightOptions &options,
                                  const BspSpace &space, const std::vector<bool> &skySeenFrom, int &culled,
                                  bool fastPoint = true);

/// For each cluster, whether it sees a cluster with a sky surface. Empty, which means that all do, if any sky surface
/// is in no leaf.
std::vector<bool> SkySeenFrom(const BspSpace &space, const SurfaceTable &table);

} // namespace q3
