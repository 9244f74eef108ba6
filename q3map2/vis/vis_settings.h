// GPL-2.0-or-later. The options of the vis stage, declared.
#pragma once

#include "common/settings.h"
#include "q3map2/vis/vis_options.h"

namespace q3 {

/// The options of the vis stage, except those that all stages accept.
std::vector<SettingGroup<VisStageOptions>> VisSettings();

} // namespace q3
