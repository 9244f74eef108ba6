// GPL-2.0-or-later. The options of the SH light grid and of ambient cubes, declared.
#pragma once

#include "q3map2/light/options/light_options.h"

#include <vector>

namespace q3 {

/// The groups of LightOptionSettings that are about grids, which come first there.
std::vector<SettingGroup<LightOptions>> GridSettings();

} // namespace q3
