// GPL-2.0-or-later. The options of lights and light grids, declared.
#pragma once

#include "common/settings.h"
#include "q3map2/light/options/light_options.h"

namespace q3 {

/// The options of the light stage that concern light sources and the grids. Those of lightmaps: LightmapSettings.
std::vector<SettingGroup<LightOptions>> LightOptionSettings();

} // namespace q3
