// GPL-2.0-or-later. Options of the stages -json and -analyze.
#include "q3map2/convert/convert_options.h"

#include "common/error.h"

namespace q3 {

std::vector<SettingGroup<JsonOptions>> JsonSettings() {
    return {
        {"JSON",
         "The files are described in [json.md](json.md).",
         {{{.name = "-unpack", .initial = "this, without -pack", .help = "Write all lumps as JSON files into maps/x/"},
           &JsonOptions::unpack},
          {{.name = "-pack", .help = "Read these files and write maps/x_json.bsp"}, &JsonOptions::pack},
          {{.name = "-useflagnames", .help = "With -pack: take surface flags by their names in the game's table"},
           &JsonOptions::useFlagNames},
          {{.name = "-skipflags", .help = "With -useflagnames: drop names that the table does not have"},
           &JsonOptions::dropUnknownFlags}}}};
}

JsonOptions ParseJsonOptions(Arguments &arguments, Log &log) {
    JsonOptions options;
    TakeSettings(JsonSettings(), options, arguments, log);
    if (options.pack && options.unpack)
        throw Error("-json: -pack and -unpack exclude each other");
    return options;
}

std::vector<SettingGroup<AnalyzeOptions>> AnalyzeSettings() {
    return {{"Directory",
             "",
             {{{.name = "-lumpswap", .help = "The directory holds the length of each lump before its offset"},
               &AnalyzeOptions::lumpSwap}}}};
}

} // namespace q3
