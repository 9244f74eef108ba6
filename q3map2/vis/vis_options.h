// GPL-2.0-or-later. Options of the vis stage.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "q3map2/vis/vis.h"

namespace q3 {

/// Declared in vis_settings.cpp.
struct VisStageOptions {
    VisOptions vis;
    bool savePrt = false;
    bool histogram = false; ///< a second -v: how many clusters see how many others
};

/// Takes the options of the vis stage off `arguments`. Errors: those of TakeSettings.
VisStageOptions ParseVisOptions(Arguments &arguments, Log &log);

} // namespace q3
