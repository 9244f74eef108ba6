// GPL-2.0-or-later. Options of the vis stage.
#include "q3map2/vis/vis_options.h"

#include "q3map2/vis/vis_settings.h"

namespace q3 {

VisStageOptions ParseVisOptions(Arguments &arguments, Log &log) {
    VisStageOptions options;
    TakeSettings(VisSettings(), options, arguments, log);
    options.vis.merge |= options.vis.keepHints;
    options.vis.passageOnly &= !options.vis.noPassage;
    return options;
}

} // namespace q3
