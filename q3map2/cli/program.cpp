// GPL-2.0-or-later. The program: its stages, and the way from a command line to one of them.
#include "q3map2/cli/program.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"
#include "q3map2/cli/documentation.h"
#include "q3map2/cli/help.h"
#include "q3map2/cli/presets.h"
#include "q3map2/convert/convert_options.h"
#include "q3map2/convert/preview/tone_picture.h"
#include "q3map2/edit/scale_shift.h"
#include "q3map2/editors/editor_feedback.h"
#include "q3map2/gridformats/grid_formats.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/lightmap/options/lightmap_options.h"
#include "q3map2/lightmap/store/lightmap_pages.h"
#include "q3map2/map/bsp_options.h"
#include "q3map2/minimap/minimap_options.h"
#include "q3map2/pk3/package_plan.h"
#include "q3map2/report/run_report.h"
#include "q3map2/report/version.h"
#include "q3map2/shreport/viewer_page.h"
#include "q3map2/ssbump/ssbump_files.h"
#include "q3map2/stages/global_options.h"
#include "q3map2/stages/stage.h"
#include "q3map2/vis/vis.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <new>

namespace q3 {

// ---- The stages that the command line can name ----

namespace {

/// The sections, with the section of presets in front.
std::vector<SettingSection> WithPresets(std::vector<SettingSection> sections) {
    sections.insert(sections.begin(), PresetSection());
    return sections;
}

std::vector<SettingSection> LightSections() {
    std::vector<SettingSection> sections = WithPresets(Describe(LightOptionSettings()));
    for (SettingSection &section : Describe(LightmapSettings()))
        sections.push_back(std::move(section));
    sections.push_back(VradSection());
    // Options without effect come last.
    std::stable_partition(sections.begin(), sections.end(),
                          [](const SettingSection &s) { return !s.title.starts_with("Accepted"); });
    return sections;
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
         BspStage, [] { return WithPresets(Describe(BspSettings())); }},
        {"-vis", "-vis [options] maps/x.bsp", "Compute what can be seen from where, from maps/x.prt",
         "Reads `x.bsp` and `x.prt`, which the bsp stage wrote, and puts visibility data into `x.bsp`. "
         "[vis.md](vis.md) explains when to use what.",
         VisStage, [] { return WithPresets(Describe(VisSettings())); }},
        {"-light", "-light [options] maps/x.bsp", "Light a compiled map: lightmaps, vertices and light grids", "",
         LightStage, LightSections},
        {"-convertgrid", "-convertgrid -gridformats LIST [options] maps/x.bsp",
         "Convert the SH grid of a lit map to other engines' formats",
         "[grid_formats.md](grid_formats.md) tells which engine reads which and what each loses. Light is not "
         "computed: map source, shaders and images are not needed.",
         ConvertGridStage, [] { return Describe(ConvertGridSettings()); }},
        {"-info", "-info maps/a.bsp maps/b.bsp ...", "Print counts, bytes and the light grid of maps", "", InfoStage,
         nullptr},
        {"-json", "-json [-unpack|-pack] [options] maps/x.bsp", "Write all lumps as JSON files, or read them back", "",
         JsonStage, [] { return Describe(JsonSettings()); }},
        {"-convert", "-convert [options] maps/x.bsp",
         "Write a map in another format: as a model, as map source, or for another game",
         "[convert.md](convert.md) tells what each format is for and what is lost. The input is `x.bsp`, or `x.map` if "
         "the file is named so and the format reads map sources.",
         ConvertStage, [] { return Describe(ConvertSettings()); }},
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
         "HEIGHT is a TGA, PNG, JPEG or DDS file whose luminance is the height; PNG files may have 16 bits per "
         "channel. Alpha is kept. Game files are not needed.",
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

/// Stages that other compilers have.
constexpr std::string_view kForeignStages[] = {"-vlight", "-ent"};

const Stage *FindStage(const std::vector<Stage> &stages, std::string_view word) {
    const auto found = std::ranges::find_if(stages, [&](const Stage &s) { return EqualNoCase(s.word, word); });
    return found == stages.end() ? nullptr : &*found;
}

/// Position of the stage word. A word other than the first is not one if another stage on the line has an option of
/// that name, such as -export with -light.
std::optional<std::size_t> FindStageWord(const std::vector<Stage> &stages, const std::vector<std::string> &words) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < words.size(); ++i)
        if (FindStage(stages, words[i]))
            found.push_back(i);
    const auto isOptionOfAnother = [&](std::size_t i) {
        return std::ranges::any_of(found, [&](std::size_t other) {
            return other != i && FindStage(stages, words[other])->HasOption(words[i]);
        });
    };
    std::erase_if(found, [&](std::size_t i) { return i > 0 && isOptionOfAnother(i); });
    for (const std::size_t i : found)
        if (!EqualNoCase(words[i], words[found.front()]))
            throw Error("{} and {} on one line: run one stage after the other", words[found.front()], words[i]);
    return found.empty() ? std::nullopt : std::optional(found.front());
}

} // namespace

std::vector<Stage> Stages() {
    std::vector<Stage> stages = CompilingStages();
    for (const auto &more : {PackingStages(), EditingStages()})
        stages.insert(stages.end(), more.begin(), more.end());
    return stages;
}

ChosenStage TakeStage(Arguments &arguments) {
    const std::vector<Stage> stages = Stages();
    if (arguments.Empty())
        throw Error("no arguments; q3map2 -help lists what there is");
    if (const auto at = FindStageWord(stages, arguments.Rest())) {
        const Stage stage = *FindStage(stages, arguments.TakeAt(*at));
        arguments.SetBeforeStage(*at);
        return {.stage = stage, .isNamed = true};
    }
    for (const std::string_view name : kForeignStages)
        if (EqualNoCase(arguments.Rest().front(), name)) {
            std::vector<std::string_view> words;
            for (const Stage &stage : stages)
                words.push_back(stage.word);
            throw Error("{} is not a stage of this version; it has {}", name, fmt::join(words, ", "));
        }
    return {.stage = stages.front(), .isNamed = false};
}

// ---- From the command line to a stage ----

namespace {

/// Everything that is printed goes to the file too, without the live progress of terminals.
void AddLogFile(const std::string &path, Log &log) {
    auto file = std::make_shared<std::ofstream>(std::filesystem::path(path), std::ios::binary);
    if (!*file)
        throw Error("-log {}: the file cannot be written", path);
    log.AddSink([file](LogLevel, std::string_view text) { *file << text << std::flush; });
}

/// The words without the quotes that some editors leave around them, and that pasted paths have: plain ones, those of
/// other shells, and typographic ones. A single \" goes too: in "C:\games\" the shell takes the last for a part of the
/// word.
std::vector<std::string> Unquoted(std::vector<std::string> words) {
    struct Quotes {
        std::string_view left, right;
        bool areRemovedSingly; ///< also where only one of them is there
    };
    constexpr std::array<Quotes, 3> kQuotes = {{{.left = "\"", .right = "\"", .areRemovedSingly = true},
                                                {.left = "'", .right = "'", .areRemovedSingly = false},
                                                {.left = "\u201C", .right = "\u201D", .areRemovedSingly = false}}};
    for (std::string &word : words)
        for (const Quotes &quotes : kQuotes) {
            const bool left = word.starts_with(quotes.left), right = word.ends_with(quotes.right);
            const std::size_t length = (left ? quotes.left.size() : 0) + (right ? quotes.right.size() : 0);
            if (length < word.size() && ((left && right) || (quotes.areRemovedSingly && (left || right))))
                word = word.substr(left ? quotes.left.size() : 0, word.size() - length);
        }
    return words;
}

int Run(const std::vector<std::string> &words, const std::filesystem::path &program, RunReport &report, Log &log) {
    // First, so that errors in options arrive.
    EditorFeedback::Attach(LastValueOf("-connect", words), log);
    if (const std::string file = LastValueOf("-log", words); !file.empty())
        AddLogFile(file, log);
    Arguments arguments(words);
    const GlobalOptions options = ParseGlobalOptions(arguments, log);
    if (options.help) {
        log.Print("{}", HelpText(*options.help));
        return 0;
    }
    if (options.version) {
        log.Print("{}", VersionText());
        return 0;
    }
    log.Print("{}\n", kVersion);
    const ChosenStage chosen = TakeStage(arguments);
    TranslateVradOptions(chosen.stage, arguments, log);
    ExpandPreset(chosen.stage, arguments, log);
    const std::vector<Stage> stages = Stages();
    const StageContext context{options, chosen.stage, stages, chosen.isNamed, program, arguments.Rest(), log, report};
    const int status = chosen.stage.run(context, std::move(arguments));
    log.FlushWarnings();
    report.PrintEnd(status == 0 ? RunEnd::Done : RunEnd::Failed, log);
    return status;
}

} // namespace

int RunProgram(const std::vector<std::string> &given, const std::filesystem::path &program, Log &log) {
    const std::vector<std::string> arguments = Unquoted(given);
    RunReport report;
    const std::string reportPath = LastValueOf("-report", arguments);
    ReportFile collected;
    bool reports = !reportPath.empty();
    if (reports)
        log.SetObserver(&collected);
    const auto end = [&](int status, std::string_view error) {
        log.SetObserver(nullptr);
        if (!reports)
            return status;
        try {
            collected.Write(reportPath, arguments, error);
        } catch (const Error &failure) {
            log.Write(LogLevel::Error, fmt::format("-report: {}\n", failure.what()));
            return 1;
        }
        return status;
    };
    const auto fail = [&](std::string_view text) {
        log.FlushWarnings();
        log.Write(LogLevel::Error, fmt::format("************ ERROR ************\n{}\n", text));
        report.PrintEnd(RunEnd::Failed, log);
        return end(1, text);
    };
    if (reports)
        try {
            RequireWritable(reportPath); // fail now, not after hours of computing
        } catch (const Error &error) {
            reports = false;
            return fail(fmt::format("-report: {}", error.what()));
        }
    try {
        const int status = Run(arguments, program, report, log);
        const std::string faults = report.Faults();
        return end(status, status == 0 ? "" : faults.empty() ? "the log says what is wrong" : faults);
    } catch (const Error &error) {
        return fail(error.what());
    } catch (const std::bad_alloc &) {
        return fail("out of memory");
    } catch (const std::exception &error) {
        return fail(fmt::format("unexpected failure: {}", error.what()));
    }
}

} // namespace q3
