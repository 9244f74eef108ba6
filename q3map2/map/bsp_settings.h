// GPL-2.0-or-later. The options of the bsp stage, declared.
#pragma once

#include "common/settings.h"
#include "q3map2/map/bsp_options.h"

namespace q3 {

/// Every option of the bsp stage but the ones that all stages accept.
std::vector<SettingGroup<BspOptions>> BspSettings();

} // namespace q3
