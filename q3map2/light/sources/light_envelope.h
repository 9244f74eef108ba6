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
    LegacyGrid, ///< as the established program: tolerance of entity lights and under -fast, the light's one cluster
    GridSH,     ///< no tolerance; all clusters that an area light touches
    Surfaces    ///< lightmaps and vertices: tolerance of point lights and under -fast, the light's one cluster
};

/// Prepares lights for a pass: sign of negative lights, clusters, envelope, bounds. Lights in solid are nudged out, or
/// dropped; `culled` gets the number of those dropped. Stable sort by style at the end. skySeenFrom: see SkySeenFrom.
/// fastPoint: false for -nofastpoint, for surfaces.
std::vector<Light> SetupEnvelopes(std::vector<Light> lights, LightPass pass, const LightOptions &options,
                                  const BspSpace &space, const std::vector<bool> &skySeenFrom, int &culled,
                                  bool fastPoint = true);

/// By cluster: some leaf that it sees holds a sky surface. Empty, that is everywhere, when a sky is in no leaf.
std::vector<bool> SkySeenFrom(const BspSpace &space, const SurfaceTable &table);

} // namespace q3
