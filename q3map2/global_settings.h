// GPL-2.0-or-later. The options that every stage accepts, declared.
#pragma once

#include "common/settings.h"
#include "q3map2/global_options.h"

namespace q3 {

std::vector<SettingGroup<GlobalOptions>> GlobalSettings();

} // namespace q3
