// GPL-2.0-or-later. Options of the stage -convertgrid.
#include "q3map2/gridformats/grid_format_options.h"

#include "common/error.h"
#include "q3map2/gridformats/grid_formats.h"

namespace q3 {

std::vector<SettingGroup<ConvertGridOptions>> ConvertGridSettings() {
    const auto scale = [](ConvertGridOptions &o, const SettingValues &v) { o.ambientFactor *= float(v.numbers[0]); };
    const auto goal = [](ConvertGridOptions &o) -> SparseGoal & {
        o.givenSparse = true;
        return o.sparse;
    };
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
              ErrorTargetSetting<ConvertGridOptions>(
                  "Error that `sparse` may add by interpolation: RMS",
                  "A sparse grid that the map has stays as it is, unless this option or `-shbudget` is "
                  "given: they make it again of the uniform grid, whose cells it joins but does not split.",
                  goal),
              BudgetSetting<ConvertGridOptions>("Size of the grid of `sparse`, in place of an error target", "", goal),
              {{.name = "-fixaas", .help = "Make bot files beside the map fit the written map"},
               &ConvertGridOptions::fixBotFiles}}}};
}

ConvertGridOptions ParseConvertGridOptions(Arguments &arguments, float gameAmbientFactor, Log &log) {
    ConvertGridOptions options;
    options.ambientFactor = gameAmbientFactor;
    TakeSettings(ConvertGridSettings(), options, arguments, log);
    if (options.formats.empty())
        throw Error("-convertgrid needs -gridformats LIST");
    if (options.givenSparse && !HasPlace(ParseGridFormats(options.formats), GridPlace::Sparse))
        throw Error("-sherrortarget and -shbudget need sparse in -gridformats");
    return options;
}

} // namespace q3
