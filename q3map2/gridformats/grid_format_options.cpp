// GPL-2.0-or-later. Options of the stage -convertgrid.
#include "q3map2/gridformats/grid_format_options.h"

#include "common/error.h"

namespace q3 {

std::vector<SettingGroup<ConvertGridOptions>> ConvertGridSettings() {
    const auto scale = [](ConvertGridOptions &o, const SettingValues &v) { o.ambientFactor *= float(v.numbers[0]); };
    return {{"Light grid formats",
             "",
             {{{.name = "-gridformats",
                .values = "LIST",
                .initial = "none; required",
                .help = "The formats in which the map has its light grid afterwards",
                .details = kGridFormatsDetails},
               &ConvertGridOptions::formats},
              {{.name = "-out",
                .values = "FILE.bsp",
                .initial = "the input",
                .help = "The map to write; files that go beside a map go beside that one",
                .details = "Needed if LIST has no form of the SH grid, since the map could not be converted again."},
               &ConvertGridOptions::output},
              {{.name = "-gridambientscale",
                .values = "F",
                .kind = SettingKind::Number,
                .initial = "by game, usually 1",
                .range = {.low = 0, .aboveLow = true},
                .help = "Factor of the ambient part of the legacy grid and of raw files"},
               Do<ConvertGridOptions>(scale)},
              {{.name = "-fixaas", .help = "Make bot files beside the map fit the written map"},
               &ConvertGridOptions::fixBotFiles}}}};
}

ConvertGridOptions ParseConvertGridOptions(Arguments &arguments, float gameAmbientFactor, Log &log) {
    ConvertGridOptions options;
    options.ambientFactor = gameAmbientFactor;
    TakeSettings(ConvertGridSettings(), options, arguments, log);
    if (options.formats.empty())
        throw Error("-convertgrid needs -gridformats LIST");
    return options;
}

} // namespace q3
