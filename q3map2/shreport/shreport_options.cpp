// GPL-2.0-or-later. Options of the stage -shreport.
#include "q3map2/shreport/shreport_options.h"

namespace q3 {

std::vector<SettingGroup<ShReportOptions>> ShReportSettings() {
    constexpr SettingRange sizes{0, 16384};
    return {{"Page",
             "",
             {{{.name = "-texturesize",
                .values = "N",
                .unit = "texels",
                .range = sizes,
                .help = "Longer side of a texture at most; 0: no textures"},
               &ShReportOptions::textureSize},
              {{.name = "-o", .values = "FILE", .initial = "x.html beside x.bsp", .help = "The page"},
               &ShReportOptions::output}}}};
}

ShReportOptions ParseShReportOptions(Arguments &arguments, Log &log) {
    ShReportOptions options;
    TakeSettings(ShReportSettings(), options, arguments, log);
    return options;
}

} // namespace q3
