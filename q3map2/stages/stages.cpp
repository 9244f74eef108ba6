// GPL-2.0-or-later. The stages that the command line can name.
#include "q3map2/stages/stages.h"

#include "q3map2/cli/documentation.h"
#include "q3map2/cli/presets.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/convert/convert_options.h"
#include "q3map2/convert/preview/tone_picture.h"
#include "q3map2/edit/scale_shift.h"
#include "q3map2/gridformats/grid_formats.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/lightmap/options/lightmap_options.h"
#include "q3map2/lightmap/store/lightmap_pages.h"
#include "q3map2/map/bsp_options.h"
#include "q3map2/minimap/minimap.h"
#include "q3map2/pk3/package_plan.h"
#include "q3map2/shreport/report_page.h"
#include "q3map2/ssbump/ssbump.h"
#include "q3map2/stages/recovered_lamps.h"
#include "q3map2/units/part_options.h"
#include "q3map2/vis/vis.h"
#include "q3map2/watch/options/watch_options.h"

#include <algorithm>

namespace q3 {

namespace {

/// The sections, followed by that of the options that place files of the stage.
std::vector<SettingSection> WithFiles(std::string_view stage, std::vector<SettingSection> sections) {
    for (SettingSection &section : Describe(FileSettings(stage)))
        sections.push_back(std::move(section));
    return sections;
}

/// The sections, followed by that of parts.
std::vector<SettingSection> WithParts(std::vector<SettingSection> sections) {
    for (SettingSection &section : Describe(PartSettings()))
        sections.push_back(std::move(section));
    return sections;
}

/// The sections, with the section of presets in front.
std::vector<SettingSection> WithPresets(std::vector<SettingSection> sections) {
    sections.insert(sections.begin(), PresetSection());
    return sections;
}

std::vector<SettingSection> LightSections() {
    std::vector<SettingSection> sections = WithPresets(Describe(LightOptionSettings()));
    for (SettingSection &section : Describe(LightmapSettings()))
        sections.push_back(std::move(section));
    sections = WithParts(WithFiles("-light", std::move(sections)));
    sections.push_back(VradSection());
    // The section "Accepted without effect" comes last.
    std::stable_partition(sections.begin(), sections.end(),
                          [](const SettingSection &s) { return !s.title.starts_with("Accepted"); });
    return sections;
}

/// The words of -gridformats.
std::vector<std::string> GridFormatChoices(std::string_view option) {
    std::vector<std::string> names;
    if (option == "-gridformats")
        for (const GridFormat &format : AllGridFormats())
            names.emplace_back(format.word);
    return names;
}

/// The stages from the map source to the lit map, and those that print, export or show what is in it.
std::vector<Stage> CompilingStages() {
    return {
        {"-bsp", "[-bsp] [options] maps/x.map", "Compile a map: maps/x.map to x.bsp, x.srf and x.prt",
         "The source has the extension `.map`, whether the command line has that extension, `.bsp` or none. The "
         "exceptions are `.reg`, a region of a map, and with `-onlyents` `.ent`. Without the word `-bsp` the file must "
         "not be a `.bsp`, so that a compiled map is not replaced by mistake. All files are written together at the "
         "end, and then an old `.reg` and an old `.prt` or `.lin` that does not belong to them are removed. A run that "
         "fails leaves all files as they were. A map that leaks gets `x.lin` instead of `x.prt`, which is a warning, "
         "and the exit status is 0. A map with no entity in open space is an error, because nothing tells its inside "
         "from its outside.",
         BspStage, [] { return WithPresets(WithFiles("-bsp", Describe(BspSettings()))); }, nullptr, "maps/mymap.map"},
        {"-vis", "-vis [options] maps/x.bsp", "Compute which parts of a map can be seen from where, from maps/x.prt",
         "Reads `x.bsp` and `x.prt`, which the bsp stage wrote, and stores the visibility in `x.bsp`. Deletes `x.prt` "
         "afterwards, unless `-saveprt` is given. The page [Compiling a map](../guide/compiling.md) explains which "
         "options to use when.",
         VisStage, [] { return WithPresets(WithFiles("-vis", WithParts(Describe(VisSettings())))); }},
        {"-light", "-light [options] maps/x.bsp", "Light a compiled map: lightmaps, vertices and light grids",
         "Reads `x.bsp`. If they exist, light entities are read from `x.map` and settings of surfaces from `x.srf`. "
         "The page [Lighting a map](../guide/lighting.md) shows the kinds of lights and the options that matter most.",
         LightStage, LightSections},
        {"-watch", "-watch [options] maps/x.map",
         "Compile a map and show it in a browser, again at each save of its source",
         "Runs until Ctrl-C, and prints the address of its page. After each save it runs the bsp stage, a fast vis "
         "stage "
         "and a fast light stage, and shows the result. Then it runs the vis and light stages of a play test in the "
         "background, until the next save. The page [Watching a map](../guide/watch.md) describes it.",
         WatchStage, [] { return Describe(WatchSettings()); }, nullptr, "maps/mymap.map"},
        {"-convertgrid", "-convertgrid -gridformats LIST [options] maps/x.bsp",
         "Convert the SH grid of a lit map to other engines' formats",
         "The page on [grid formats](../engines/grid_formats.md) says which engine reads which format and what each "
         "format loses. No light is computed, so the map source, shaders and images are not needed.",
         ConvertGridStage, [] { return Describe(ConvertGridSettings()); }, GridFormatChoices,
         "-gridformats sparse maps/mymap.bsp"},
        {"-info", "-info maps/a.bsp maps/b.bsp ...", "Print the counts, the bytes and the light grids of maps", "",
         InfoStage, nullptr},
        {"-json", "-json [-unpack|-pack] [options] maps/x.bsp", "Write all lumps as JSON files, or read them back", "",
         JsonStage, [] { return Describe(JsonSettings()); }},
        {"-convert", "-convert [options] maps/x.bsp",
         "Write a map in another format: as a model, as map source, or for another game",
         "The page [Utilities](../guide/utilities.md) says what each format is for and what is lost. The input is "
         "`x.bsp`, or `x.map` if the file is named so and the format reads map sources.",
         ConvertStage, [] { return Describe(ConvertSettings()); }, ConvertChoices},
        {"-export", "-export [options] maps/x.bsp", "Write the lightmaps as images maps/x/lightmap_NNNN.tga",
         "The images have 24 bits and are upside down in most viewers. HDR lightmaps are written to "
         "`lightmap_NNNN.exr`, or another format, next to them. Those of the basis vectors of radiosity normal mapping "
         "are written to `lightmap_NNNN_b1.exr` and so on.",
         ExportStage, [] { return Describe(ExportSettings()); }},
        {"-import", "-import [options] maps/x.bsp", "Replace the lightmaps of a map by the images that -export writes",
         "A lightmap whose image is missing or has another size stays. HDR lightmaps are replaced by HDR images and "
         "the others by `.tga` images, and neither changes the other.",
         ImportStage, [] { return Describe(ExportSettings()); }},
        {"-tonemap", "-tonemap [options] FILE OUT.png|OUT.tga", "Show an HDR lightmap or image as an ordinary picture",
         "FILE is a `.bsp` with HDR lightmaps, or a `.hdr`, `.exr` or `.pfm` image. The light times 2^EV, with EV from "
         "`-exposure`, is limited and encoded as sRGB. Pages have the row order of `-export`.",
         ToneMapStage, [] { return Describe(ToneMapSettings()); }, nullptr, "maps/mymap.bsp page.png"},
        {"-exportents", "-exportents maps/x.bsp", "Write the entities of a map as text: maps/x.ent",
         "The option `-onlyents` of the bsp stage puts them back.", ExportEntitiesStage, nullptr},
        {"-minimap", "-minimap [options] maps/x.bsp", "Draw a map from above, as games show it: maps/x.tga",
         "Each pixel shows how thick the solids above and below it are, without the sky, so floors are dark and walls "
         "are bright.",
         MinimapStage, [] { return Describe(MinimapSettings()); }},
        {"-analyze", "-analyze [-lumpswap] FILE", "Print what may be in the lumps of an unknown .bsp",
         "It is for files of other games, if they begin with four letters, a version and a directory of lumps.",
         AnalyzeStage, [] { return Describe(AnalyzeSettings()); }, nullptr, "unknown.bsp"},
        {"-shpreview", "-shpreview FILE.png maps/x.bsp", "Draw a picture of the light in both light grids of a map", "",
         PreviewStage, nullptr},
        {"-shreport", "-shreport [options] maps/x.bsp",
         "Write a page that shows a map and its light in a browser: maps/x.html",
         "The page is one file that needs nothing else. It contains the map as a package with its shaders, its reduced "
         "textures, and `x.lin`, `x.prt`, `x.sherror.json` and `x.unexplained.json` if they exist. The page [The "
         "viewer](../guide/viewer.md) describes it.",
         SHReportStage, [] { return Describe(SHReportSettings()); }},
        {"-ssbump", "-ssbump [options] HEIGHT OUT.tga|OUT.png",
         "Make a self-shadowed bump map from a height map, for directional lightmaps",
         "HEIGHT is a TGA, PNG, JPEG, WebP, DDS or KTX file whose luminance is the height. PNG files may have 16 bits "
         "per channel. Alpha is kept. Game files are not needed.",
         SsbumpStage, [] { return Describe(SsbumpSettings()); }, nullptr, "height.png bump.tga"}};
}

std::vector<Stage> PackingStages() {
    return {{"-pk3", "-pk3 [options] maps/x.bsp ...", "Pack maps with all that they need into x_autopacked.pk3",
             "The page [Releasing a map](../guide/releasing.md#the-package) says what goes into the package. The name "
             "is that of the last map. If something is missing, it is listed at the end, the file is named "
             "`x_FAILEDpack.pk3`, and the exit status is 1.",
             PackStage, [] { return Describe(PackSettings()); }},
            {"-repack", "-repack [options] maps/x.bsp ...|LIST.txt",
             "Pack everything the maps need except the maps, with one script of only the shaders in use",
             "It is for packages of many maps. Writes `x_repacked.pk3`, with images, sounds, videos and models, and "
             "`x_strippedBYrepacker.shader`. Neither the script nor the maps are in the package. LIST.txt names one "
             "map per line. The name is that of the last map.",
             RepackStage, [] { return Describe(RepackSettings()); }}};
}

std::vector<Stage> EditingStages() {
    return {{"-scale", "-scale [options] S|SXY SZ|SX SY SZ maps/x.bsp", "Make a map larger or smaller: x_s.bsp",
             "Scales the geometry, the keys `origin`, `height` and `gridsize`, the `lip` of movers, and the cells of "
             "light grids. Speeds, radii and light values stay.",
             ScaleStage, [] { return Describe(ScaleSettings()); }, nullptr, "2 maps/mymap.bsp"},
            {"-shift", "-shift S|SXY SZ|SX SY SZ maps/x.bsp", "Move a map as a whole: x_sh.bsp",
             "The legacy light grid is dropped with a warning unless each distance is a multiple of `gridsize`, since "
             "engines place its points at multiples. The SH grid moves along.",
             ShiftStage, nullptr},
            {"-mergebsp", "-mergebsp [options] maps/x.bsp maps/y.bsp",
             "Add the entities of y, and its world if asked, to x: x_merged.bsp",
             "The tree, the visibility, the light grids and the bounds of the world are those of x. The light of "
             "static props is that of both maps.",
             MergeStage, [] { return Describe(MergeSettings()); }, nullptr, "maps/mymap.bsp maps/other.bsp"},
            {"-recoverlights", "-recoverlights [options] maps/x.bsp",
             "Find the lamps of a lit map whose source is lost",
             "Finds point lights and spotlights that explain the lightmaps, vertex colors and the legacy light grid, "
             "and writes them as light entities to `x.lights.map`. The light stage reads that file if there is no "
             "`x.map`, and also `x.lights.rad`, which has factors for shaders that emit less light than their "
             "scripts say. Neither file is replaced unless `-force` is given. What the lamps leave unexplained goes to "
             "`x.unexplained.json`, which [the viewer](../guide/viewer.md) shows. See [Lamps of lit "
             "maps](../recover_lights.md).",
             RecoverStage, [] { return Describe(RecoverSettings()); }},
            {"-fixaas", "-fixaas maps/x.bsp", "Make the bot files of a map valid again after relighting",
             "A bot file names its map by a checksum of all bytes, so engines refuse it after the map is lit. This "
             "stage writes the new checksum into those of `x.aas`, `x_b0.aas` and `x_b1.aas` that exist. It is correct "
             "only if no brush has changed since the bot file was made.",
             FixAasStage, nullptr},
            {"-editorfiles", "-editorfiles DIR", "Write build menus and profiles for level editors into a folder",
             "For NetRadiant and GtkRadiant 1.5 it writes `netradiant/default_build_menu.xml`, and for GtkRadiant 1.6 "
             "`gtkradiant/default_project.proj`. For TrenchBroom it writes `CompilationProfiles.cfg`, "
             "`GameEngineProfiles.cfg` and `GameConfig.cfg` in `trenchbroom`. All are for the game of `-game`. The "
             "page [In a level editor](../guide/editors.md) says where they go and what the entries do.",
             EditorFilesStage, nullptr}};
}

} // namespace

std::vector<Stage> Stages() {
    std::vector<Stage> stages = CompilingStages();
    for (const auto &more : {PackingStages(), EditingStages()})
        stages.insert(stages.end(), more.begin(), more.end());
    return stages;
}

} // namespace q3
