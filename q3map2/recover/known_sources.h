// GPL-2.0-or-later. How strong the surfaces and skies that emit light were when the map was lit.
#pragma once

#include "q3map2/recover/observed_light.h"

#include <string>
#include <vector>

namespace q3 {

/// A shader that emits light.
struct KnownSource {
    std::string shader;
    float factor = 1; ///< of its light in the file, in units of that by its script
};

/// Compares the light of each shader that emits some with the stored light, which includes that of lamps not known yet.
/// At places where a shader gives most of the known light, the ratio of the stored light, less that of other known
/// sources, to its own is at least its factor, but for shadows that differ; so the factor is a low percentile of these
/// ratios. It is 1 where that is about 1 or more, since lamps can stand for the rest, and for shaders that dominate few
/// places.
std::vector<KnownSource> FitKnownSources(const ObservedMap &map, const LightSetup &setup,
                                         const LightmapOptions &lightmap, const JobPool &jobs);

} // namespace q3
