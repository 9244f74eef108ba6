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
#include "q3map2/vis/vis.h"

#include <algorithm>

namespace q3 {

namespace {

/// The sections, followed by that of the options that place files of the stage.
std::vector<SettingSection> WithFiles(std::string_view stage, std::vector<SettingSection> sections) {
    for (SettingSection &section : Describe(FileSettings(stage)))
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
    sections = WithFiles("-light", std::move(sections));
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
         "The source has the extension `.map` whether the line has it, `.bsp` or none, but for `.reg` (a region of a "
         "map) and, with `-onlyents`, `.ent`. Without the word `-bsp` the file must not be a `.bsp`, so that a "
         "compiled map is not replaced by mistake. All files are written together at the end, and then an old `.prt` "
         "or `.lin` that does not belong to them and an old `.reg` are removed; a run that fails leaves all as they "
         "were. A map that leaks gets `x.lin` in place of `x.prt`; that is a warning, and the exit status is 0. A map "
         "without an entity in the open is an error, because nothing tells its inside from its outside.",
         BspStage, [] { return WithPresets(WithFiles("-bsp", Describe(BspSettings()))); }},
        {"-vis", "-vis [options] maps/x.bsp", "Compute what can be seen from where, from maps/x.prt",
         "Reads `x.bsp` and `x.prt`, which the bsp stage wrote, and puts visibility data into `x.bsp`. "
         "[vis.md](vis.md) explains when to use what.",
         VisStage, [] { return WithPresets(WithFiles("-vis", Describe(VisSettings()))); }},
        {"-light", "-light [options] maps/x.bsp", "Light a compiled map: lightmaps, vertices and light grids", "",
         LightStage, LightSections},
        {"-convertgrid", "-convertgrid -gridformats LIST [options] maps/x.bsp",
         "Convert the SH grid of a lit map to other engines' formats",
         "[grid_formats.md](grid_formats.md) tells which engine reads which and what each loses. Light is not "
         "computed: map source, shaders and images are not needed.",
         ConvertGridStage, [] { return Describe(ConvertGridSettings()); }, GridFormatChoices},
        {"-info", "-info maps/a.bsp maps/b.bsp ...", "Print counts, bytes and the light grid of maps", "", InfoStage,
         nullptr},
        {"-json", "-json [-unpack|-pack] [options] maps/x.bsp", "Write all lumps as JSON files, or read them back", "",
         JsonStage, [] { return Describe(JsonSettings()); }},
        {"-convert", "-convert [options] maps/x.bsp",
         "Write a map in another format: as a model, as map source, or for another game",
         "[convert.md](convert.md) tells what each format is for and what is lost. The input is `x.bsp`, or `x.map` if "
         "the file is named so and the format reads map sources.",
         ConvertStage, [] { return Describe(ConvertSettings()); }, ConvertChoices},
        {"-export", "-export [options] maps/x.bsp", "Write the lightmaps as images maps/x/lightmap_NNNN.tga",
         "24 bit, upside down in most viewers. HDR lightmaps go to `lightmap_NNNN.exr` or another format beside them, "
         "those of the basis vectors of radiosity normal mapping to `lightmap_NNNN_b1.exr` and so on.",
         ExportStage, [] { return Describe(ExportSettings()); }},
        {"-import", "-import [options] maps/x.bsp", "Replace the lightmaps by these images",
         "A lightmap whose image is missing or has another size stays. HDR lightmaps are replaced by HDR images, the "
         "others by `.tga`: neither changes the other.",
         ImportStage, [] { return Describe(ExportSettings()); }},
        {"-tonemap", "-tonemap [options] FILE OUT.png|OUT.tga", "Show an HDR lightmap or image as an ordinary picture",
         "FILE is a `.bsp` with HDR lightmaps or an image: `.hdr`, `.exr`, `.pfm`. Light times 2^EV is limited and "
         "encoded as sRGB. Pages have the row order of `-export`.",
         ToneMapStage, [] { return Describe(ToneMapSettings()); }},
        {"-exportents", "-exportents maps/x.bsp", "Write the entities of a map as text: maps/x.ent",
         "`-onlyents` of the bsp stage puts them back.", ExportEntitiesStage, nullptr},
        {"-minimap", "-minimap [options] maps/x.bsp", "Draw a map from above, as games show it: maps/x.tga",
         "Each pixel tells how thick the solids above and below it are, without the sky: floors are dark, walls are "
         "bright.",
         MinimapStage, [] { return Describe(MinimapSettings()); }},
        {"-analyze", "-analyze [-lumpswap] FILE", "Print what may be in the lumps of an unknown .bsp",
         "For files of other games: any that begin with four letters, a version and a directory of lumps.",
         AnalyzeStage, [] { return Describe(AnalyzeSettings()); }},
        {"-shpreview", "-shpreview FILE.png maps/x.bsp", "Draw what both light grids of a map show to a picture", "",
         PreviewStage, nullptr},
        {"-shreport", "-shreport [options] maps/x.bsp",
         "Write a page that shows a map and its light in a browser: maps/x.html",
         "The page is one file that needs nothing else: the map is in it as a package, with `x.lin`, `x.prt` and "
         "`x.sherror.json` if they are beside it, its shaders and its textures, reduced. "
         "[tools_for_maps.md](tools_for_maps.md#report-a-map-in-a-browser) tells what is in it.",
         SHReportStage, [] { return Describe(SHReportSettings()); }},
        {"-ssbump", "-ssbump [options] HEIGHT OUT.tga|OUT.png",
         "Make a self-shadowed bump map from a height map, for directional lightmaps",
         "HEIGHT is a TGA, PNG, JPEG, WebP, DDS or KTX file whose luminance is the height; PNG files may have 16 "
         "bits per channel. Alpha is kept. Game files are not needed.",
         SsbumpStage, [] { return Describe(SsbumpSettings()); }}};
}

std::vector<Stage> PackingStages() {
    return {
        {"-pk3", "-pk3 [options] maps/x.bsp ...", "Pack maps with all that they need into x_autopacked.pk3",
         "[package.md](package.md) tells what goes in. What is missing is listed at the end; then the file is named "
         "`x_FAILEDpack.pk3`, and the exit status is 1. The name is that of the last map.",
         PackStage, [] { return Describe(PackSettings()); }},
        {"-repack", "-repack [options] maps/x.bsp ...|LIST.txt",
         "Pack everything the maps need except the maps, with one script of only the shaders in use",
         "For packages of many maps: writes `x_repacked.pk3`, with images, sounds, videos and models, and "
         "`x_strippedBYrepacker.shader`. Neither the script nor the maps are in the package. LIST.txt names one map "
         "per line. The name is that of the last map.",
         RepackStage, [] { return Describe(RepackSettings()); }}};
}

std::vector<Stage> EditingStages() {
    return {
        {"-scale", "-scale [options] S|SXY SZ|SX SY SZ maps/x.bsp", "Make a map larger or smaller: x_s.bsp",
         "Scales geometry, `origin`, `height`, the `lip` of movers, `gridsize` and the cells of light grids. Speeds, "
         "radii and light values stay.",
         ScaleStage, [] { return Describe(ScaleSettings()); }},
        {"-shift", "-shift S|SXY SZ|SX SY SZ maps/x.bsp", "Move a map as a whole: x_sh.bsp",
         "The legacy light grid is dropped with a warning unless each distance is a multiple of `gridsize`, since "
         "engines place its points at multiples. The SH grid moves along.",
         ShiftStage, nullptr},
        {"-mergebsp", "-mergebsp [options] maps/x.bsp maps/y.bsp",
         "Add the entities of y, and its world if asked, to x: x_merged.bsp",
         "Tree, visibility, light grids and world bounds are those of x; light of static props is that of both.",
         MergeStage, [] { return Describe(MergeSettings()); }},
        {"-fixaas", "-fixaas maps/x.bsp", "Make bot files beside a map fit it again",
         "A bot file names its map by a checksum of all bytes, so lighting a map makes engines refuse a good file. "
         "This enters the new checksum into `x.aas`, `x_b0.aas` and `x_b1.aas`, as far as they exist. Correct only if "
         "no brush has changed since the file was made.",
         FixAasStage, nullptr},
        {"-editorfiles", "-editorfiles DIR", "Write build menus and profiles for level editors into a folder",
         "`netradiant/default_build_menu.xml` (NetRadiant, GtkRadiant 1.5), `gtkradiant/default_project.proj` "
         "(GtkRadiant 1.6), `CompilationProfiles.cfg`, `GameEngineProfiles.cfg` and `GameConfig.cfg` in `trenchbroom`, "
         "for the game of `-game`. [editors.md](editors.md) tells where they go and what the entries do.",
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
