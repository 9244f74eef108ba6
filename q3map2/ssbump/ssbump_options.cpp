// GPL-2.0-or-later. Options of the stage -ssbump.
#include "q3map2/ssbump/ssbump_options.h"

namespace q3 {

std::vector<SettingGroup<SsbumpOptions>> SsbumpSettings() {
    constexpr SettingRange scales{-1000, 1000}, rays{4, 1024}, passes{0, 1000};
    return {{"Bump map",
             "[ssbump.md](ssbump.md) tells how shaders use it.",
             {{{.name = "-bumpscale",
                .values = "F",
                .unit = "texels",
                .range = scales,
                .help = "Height of white over black; below 0: white is deep"},
               &SsbumpOptions::bumpScale},
              {{.name = "-notile", .help = "The image does not repeat: nothing beyond its edges casts a shadow"},
               Off(&SsbumpOptions::tile)},
              {{.name = "-rays",
                .values = "N",
                .range = rays,
                .help = "Directions all around along which a texel looks for its horizon"},
               &SsbumpOptions::rays},
              {{.name = "-filter",
                .values = "N",
                .range = passes,
                .help = "Passes that smooth the steps of slopes, by at most half a step of the image",
                .details = "For smooth heights of 8 bits, with 32 or so. Rough ones get worse."},
               &SsbumpOptions::filter},
              {{.name = "-normals",
                .values = "FILE",
                .initial = "none",
                .help = "Write the normals too, without shadows, as q3map_normalImage reads them"},
               &SsbumpOptions::normals}}}};
}

SsbumpOptions ParseSsbumpOptions(Arguments &arguments, Log &log) {
    SsbumpOptions options;
    TakeSettings(SsbumpSettings(), options, arguments, log);
    return options;
}

} // namespace q3
