// GPL-2.0-or-later. Options of the stages -json, -analyze and -convert.
#include "q3map2/convert/convert_options.h"

#include "common/error.h"

namespace q3 {

std::vector<SettingGroup<JsonOptions>> JsonSettings() {
    return {{"JSON",
             "The page [A map as JSON](json.md) describes the files.",
             {{{.name = "-unpack",
                .initial = "this, without -pack",
                .help = "Writes all lumps as JSON files into maps/x/",
                .since = "q3map2"},
               &JsonOptions::unpack},
              {{.name = "-pack", .help = "Reads the files of -unpack and writes maps/x_json.bsp", .since = "q3map2"},
               &JsonOptions::pack},
              {{.name = "-useflagnames",
                .help = "Makes -pack take surface flags by their names in the table of the game",
                .since = "q3map2"},
               &JsonOptions::useFlagNames},
              {{.name = "-skipflags",
                .help = "Makes -useflagnames drop names that the table does not have",
                .since = "q3map2"},
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
             {{{.name = "-lumpswap",
                .help = "Reads a directory that holds the length of each lump before its offset",
                .since = "q3map2"},
               &AnalyzeOptions::lumpSwap}}}};
}

namespace {

using ConvertGroup = SettingGroup<ConvertOptions>;

ConvertGroup InputAndOutput() {
    return {
        "Input and output",
        "",
        {{{.name = "-format",
           .values = "NAME",
           .initial = "ase",
           .help = "Chooses what to write: ase, obj, map, map_bp, map_220, or the name of a game",
           .details = "The formats `ase` and `obj` are models of what is drawn, written as `x.ase`, or as `x.obj` with "
                      "`x.mtl`. The map formats write `x_converted.map`: `map` has classic texture axes, `map_bp` has "
                      "brush primitives, and `map_220` has the axes of Valve. The name of a game (`-help game`) writes "
                      "`x_c.bsp` with the file version of that game and with its surfaceparms of the same names. The "
                      "option `-game` says which game `x.bsp` is of. Files are written next to the input.",
           .since = "q3map2",
           .example = "map_220"},
          &ConvertOptions::format},
         {{.name = "-readmap",
           .initial = "by the file name, if the format reads map sources",
           .help = "Reads the map source, whatever the file name says",
           .since = "q3map2"},
          &ConvertOptions::readMap},
         {{.name = "-readbsp", .help = "Reads the .bsp, whatever the file name says", .since = "q3map2"},
          &ConvertOptions::readBsp}}};
}

ConvertGroup MapFormats() {
    constexpr SettingRange epsilon{.low = 0, .high = 1, .aboveLow = true, .belowHigh = true};
    return {"Map formats",
            "An option that means nothing for the format or the input is an error.",
            {{{.name = "-fast",
               .help = "Does not look for texture axes when a .bsp is converted",
               .details = "All sides get default axes of 0.5 game units per texel.",
               .since = "q3map2"},
              &ConvertOptions::fast},
             {{.name = "-modelclip",
               .help = "Keeps the brushes that the compiler made to clip models, when a .bsp is converted",
               .since = "q3map2"},
              &ConvertOptions::keepModelClip},
             {{.name = "-wtf",
               .help = "Marks the sides that no surface shows when a .bsp is converted",
               .details = "They get the shader `common/WTF`, except those whose shader is in `common/` or `system/`. "
                          "Without this option they keep their shader, with default texture axes.",
               .since = "q3map2"},
              &ConvertOptions::markUnknown},
             {{.name = "-ne",
               .values = "F",
               .initial = "5e-05",
               .range = epsilon,
               .help = "Sets the difference up to which the plane normals of a map source are equal",
               .since = "q3map2",
               .example = "0.0001"},
              &ConvertOptions::normalEpsilon},
             {{.name = "-de",
               .values = "F",
               .unit = "game units",
               .initial = "0.005",
               .range = epsilon,
               .help = "Sets the difference up to which plane distances are equal",
               .details = "From a .bsp it is also the distance up to which a point is on the edge of a triangle that "
                          "shows texture axes.",
               .since = "q3map2",
               .example = "0.01"},
              &ConvertOptions::distanceEpsilon}}};
}

ConvertGroup Models() {
    return {
        "Models",
        "These options are for `ase` and `obj`. With `-readmap` the map source is compiled first, without visibility "
        "and light.",
        {{{.name = "-shadersasbitmap",
           .aliases = {"-shaderasbitmap"},
           .help = "Names the images of materials by their shader instead of the path of a file",
           .since = "q3map2"},
          &ConvertOptions::shadersAsBitmap},
         {{.name = "-lightmapsastexcoord",
           .aliases = {"-lightmapastexcoord"},
           .help = "Writes the coordinates in lightmaps, and one material per lightmap",
           .since = "q3map2"},
          &ConvertOptions::lightmapsAsTexCoord},
         {{.name = "-deluxemapsastexcoord",
           .aliases = {"-deluxemapastexcoord"},
           .help = "Writes the coordinates in lightmaps, and one material per image of light directions",
           .since = "q3map2"},
          &ConvertOptions::deluxemapsAsTexCoord},
         {{.name = "-meta", .help = "Merges the brush faces of a map source into triangle surfaces", .since = "q3map2"},
          &ConvertOptions::meta},
         {{.name = "-patchmeta",
           .help = "Turns the patches of a map source into triangle surfaces too",
           .details = "Implies `-meta`.",
           .since = "q3map2"},
          &ConvertOptions::patchMeta}}};
}

} // namespace

std::vector<SettingGroup<ConvertOptions>> ConvertSettings() {
    return {InputAndOutput(), MapFormats(), Models()};
}

ConvertOptions ParseConvertOptions(Arguments &arguments, Log &log) {
    ConvertOptions options;
    TakeSettings(ConvertSettings(), options, arguments, log);
    if (options.readBsp && options.readMap)
        throw Error("-convert: -readbsp and -readmap exclude each other");
    return options;
}

} // namespace q3
