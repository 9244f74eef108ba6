// GPL-2.0-or-later. Options of the stage -watch.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "common/settings.h"

#include <string>
#include <vector>

namespace q3 {

struct WatchOptions {
    std::string bsp = "-meta";             ///< options of the bsp stage
    std::string vis;                       ///< of the vis stage of the second pass
    std::string light = "-preset normal";  ///< of the light stage of the second pass
    std::string draft = "-faster -nogrid -samplescale 2"; ///< of the light stage of the first pass
    int port = 0;                          ///< 0: a free one
    int textureSize = 128;                 ///< most texels on the longer side of a texture; 0: no textures
    bool open = false;                     ///< the browser opens the page
};

/// The options of the stage, declared.
std::vector<SettingGroup<WatchOptions>> WatchSettings();

/// Takes them off `arguments`. Errors: those of TakeSettings, and options of stages that place files elsewhere, or that
/// make another file than the .bsp.
WatchOptions ParseWatchOptions(Arguments &arguments, Log &log);

/// The words of an option such as WatchOptions::light, separated by blanks; double quotes keep blanks.
std::vector<std::string> WordsOf(const std::string &options);

} // namespace q3
