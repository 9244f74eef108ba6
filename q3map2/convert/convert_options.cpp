// GPL-2.0-or-later. Options of the stages -json, -analyze and -convert.
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

namespace {

using ConvertGroup = SettingGroup<ConvertOptions>;

ConvertGroup InputAndOutput() {
    return {"Input and output",
            "",
            {{{.name = "-format",
               .values = "NAME",
               .initial = "ase",
               .help = "What to write: ase, obj, map, map_bp, map_220, or the name of a game",
               .details =
                   "`ase` and `obj` are models of what is drawn: `x.ase`, or `x.obj` with `x.mtl`. `map` has classic "
                   "texture axes, `map_bp` brush primitives, `map_220` those of Valve; all three write "
                   "`x_converted.map`. A game (`-help game`): `x_c.bsp`, with its file version and its surfaceparms "
                   "of the same names; -game says which game `x.bsp` is of. Files are written beside the input."},
              &ConvertOptions::format},
             {{.name = "-readmap",
               .initial = "by the file name, if the format reads map sources",
               .help = "Read the map source, whatever the file name says"},
              &ConvertOptions::readMap},
             {{.name = "-readbsp", .help = "Read the .bsp, whatever the file name says"}, &ConvertOptions::readBsp}}};
}

ConvertGroup MapFormats() {
    constexpr SettingRange epsilon{.low = 0, .high = 1, .aboveLow = true, .belowHigh = true};
    return {
        "Map formats",
        "An option that means nothing for the format or the input is an error.",
        {{{.name = "-fast",
           .help = "From a .bsp: do not look for texture axes",
           .details = "All sides get default ones, 0.5 game units a texel."},
          &ConvertOptions::fast},
         {{.name = "-modelclip", .help = "From a .bsp: keep the brushes that the compiler made to clip models"},
          &ConvertOptions::keepModelClip},
         {{.name = "-wtf",
           .help = "From a .bsp: mark sides that no surface shows",
           .details = "They get the shader `common/WTF`, but for those of `common/` and `system/`. Otherwise they keep "
                      "their shader, with default texture axes."},
          &ConvertOptions::markUnknown},
         {{.name = "-ne",
           .values = "F",
           .initial = "5e-05",
           .range = epsilon,
           .help = "From a map source: difference up to which plane normals are equal"},
          &ConvertOptions::normalEpsilon},
         {{.name = "-de",
           .values = "F",
           .unit = "game units",
           .initial = "0.005",
           .range = epsilon,
           .help = "Difference up to which plane distances are equal",
           .details =
               "From a .bsp: distance up to which a point is on the edge of a triangle that shows texture axes."},
          &ConvertOptions::distanceEpsilon}}};
}

ConvertGroup Models() {
    return {
        "Models",
        "For `ase` and `obj`. With `-readmap` the map source is compiled first, without visibility and light.",
        {{{.name = "-shadersasbitmap",
           .aliases = {"-shaderasbitmap"},
           .help = "Name the images of materials by their shader, not by the path of a file"},
          &ConvertOptions::shadersAsBitmap},
         {{.name = "-lightmapsastexcoord",
           .aliases = {"-lightmapastexcoord"},
           .help = "Write the coordinates in lightmaps, and a material a lightmap"},
          &ConvertOptions::lightmapsAsTexCoord},
         {{.name = "-deluxemapsastexcoord",
           .aliases = {"-deluxemapastexcoord"},
           .help = "The same with the images of light directions"},
          &ConvertOptions::deluxemapsAsTexCoord},
         {{.name = "-meta", .help = "From a map source: merge brush faces into triangle surfaces"},
          &ConvertOptions::meta},
         {{.name = "-patchmeta", .help = "From a map source: turn patches into triangle surfaces too; includes -meta"},
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
