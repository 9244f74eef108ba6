// GPL-2.0-or-later. Options of the stage -shreport.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "common/settings.h"

#include <string>
#include <vector>

namespace q3 {

struct ShReportOptions {
    std::string output;    ///< path of the page; empty: x.html beside x.bsp
    int textureSize = 128; ///< most texels on the longer side of a texture; 0: no textures
};

/// The options of the stage, declared.
std::vector<SettingGroup<ShReportOptions>> ShReportSettings();
/// Takes them off `arguments`.
ShReportOptions ParseShReportOptions(Arguments &arguments, Log &log);

} // namespace q3
