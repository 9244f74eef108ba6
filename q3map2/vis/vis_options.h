// GPL-2.0-or-later. Options of the vis stage.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "q3map2/vis/vis.h"

namespace q3 {

/// Set by the command-line options in the table of vis_settings.cpp.
struct VisStageOptions {
    VisOptions vis;
    bool savePrt = false;
    bool histogram = false; ///< set by a second -v: print the number of clusters for each count of visible clusters
};

/// Takes the options of the vis stage off `arguments`. Errors: those of TakeSettings.
VisStageOptions ParseVisOptions(Arguments &arguments, Log &log);

} // namespace q3
