// GPL-2.0-or-later. The options of lightmaps, vertex light and bounces, declared.
#pragma once

#include "common/settings.h"
#include "q3map2/lightmap/options/lightmap_options.h"

namespace q3 {

/// The options of the light stage that LightSettings lacks: lightmaps, vertex light, bounces.
std::vector<SettingGroup<LightmapOptions>> LightmapSettings();

} // namespace q3
