// GPL-2.0-or-later. q3map2 -pk3, -repack and -shreport: maps with the game's files that they need.
#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"
#include "q3map2/cli/global_options.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/lightmap/explain/explain.h"
#include "q3map2/lightmap/store/lightmap_scripts.h"
#include "q3map2/pk3/package_plan.h"
#include "q3map2/report/run_report.h"
#include "q3map2/shreport/report_page.h"
#include "q3map2/stages/light_files.h"
#include "q3map2/stages/stages.h"
#include "q3map2/stages/written_map.h"

#include <algorithm>

namespace q3 {

// ---- q3map2 -pk3 and -repack: maps and the game's files in, a package out ----

namespace {

namespace fs = std::filesystem;

/// The game folders that the maps are in: there their scripts, images and sounds may be.
std::vector<fs::path> FoldersOf(const std::vector<fs::path> &maps) {
    std::vector<fs::path> folders;
    for (const fs::path &map : maps)
        if (fs::path folder = GameFolderOfMap(map.string());
            !folder.empty() && std::ranges::find(folders, folder) == folders.end())
            folders.push_back(std::move(folder));
    return folders;
}

Exclusions LoadExclusions(const StageContext &context, const PackOptions &options) {
    const fs::path beside = context.program.parent_path() / fmt::format("{}.exclude", context.options.game->name);
    Exclusions all;
    if (fs::exists(beside))
        all = ReadExclusions(ReadTextFile(beside), beside.string());
    else if (options.exclusions.empty() && options.basePaks.empty())
        context.log.Warn("no exclusions",
                         "{} does not exist, nor is there a -basepak or -exclude: files that every player has are "
                         "packed too",
                         beside.string());
    for (const std::string &file : options.exclusions)
        all.Add(ReadExclusions(ReadTextFile(file), file));
    return all;
}

fs::path OutputFolder(const StageContext &context, const PackOptions &options) {
    if (!options.folder.empty()) {
        const fs::path folder = fs::absolute(options.folder);
        MakeFolder(folder);
        return folder;
    }
    const std::vector<fs::path> paths = BasePaths(context.options, context.words, context.program);
    if (paths.empty())
        throw Error("-fs_nobasepath leaves no folder for the package; give one by -outdir or -fs_basepath");
    return paths.front();
}

/// Guards the maps and the outputs. Maps are most of a package; a quarter of their size is assumed for it.
FileGuard GuardPackage(const std::vector<fs::path> &outputs, const std::vector<fs::path> &maps,
                       const StageContext &context) {
    FileGuard guard(context);
    std::uint64_t bytes = 0;
    for (const fs::path &map : maps) {
        guard.Needs(map);
        bytes += SizeOfFile(map) / 4;
    }
    for (const fs::path &output : outputs) {
        guard.Writes(output, bytes);
        bytes = 0; // only one of the outputs is large
    }
    return guard;
}

/// Whether a single word that is not a .bsp may name a text file that lists maps, one per line.
enum class MapLists { Refuse, Allow };

/// Maps that the words name. Errors: no maps in the list.
std::vector<fs::path> MapsOf(const std::vector<std::string> &words, MapLists lists) {
    std::vector<fs::path> maps;
    for (const std::string &word : words) {
        const fs::path map = MapPath(word, ".bsp");
        const bool isList = lists == MapLists::Allow && words.size() == 1 && map == fs::absolute(word) &&
                            fs::is_regular_file(map) && !EqualNoCase(map.extension().string(), ".bsp");
        if (!isList) {
            RequireMap(map);
            maps.push_back(map);
            continue;
        }
        const std::string text = ReadTextFile(word);
        for (std::string_view rest = text; !rest.empty();) {
            const std::size_t end = std::min(rest.find('\n'), rest.size());
            std::string line(rest.substr(0, end));
            rest.remove_prefix(std::min(end + 1, rest.size()));
            while (!line.empty() && IsBlank(line.back()))
                line.pop_back();
            if (!line.empty())
                maps.push_back(ExistingBsp(line));
        }
    }
    if (maps.empty())
        throw Error("the list names no maps");
    return maps;
}

std::vector<std::string> TakeMaps(const StageContext &context, Arguments &arguments) {
    std::vector<std::string> words = TakeFiles(context, arguments);
    if (words.empty())
        throw Error("usage: q3map2 {}", context.stage.usage);
    PrintChangedOptions(arguments, context.log);
    return words;
}

/// Warns of bot files that do not fit the packed map: those beside it, and those of archives that engines would take,
/// whether they are packed or not.
void WarnOfBotFiles(const fs::path &map, const PackageSource &source, const PackagePlan &plan, Log &log) {
    BotCheck(map, log).Report(BotCheck::SameGeometry, BotCheck::OnlyWarn);
    for (const std::string_view end : kBotFileEnds) {
        const std::string name = fmt::format("maps/{}{}", map.stem().string(), end);
        const auto entry = std::ranges::find(plan.Files(), name, &PackageEntry::name);
        if (entry != plan.Files().end() && !entry->disk.empty())
            continue;
        if (const auto bytes = source.Read(name))
            WarnOfPackedBotFile(map, *bytes, source.Location(name), log);
    }
}

/// What both stages start with: the maps that the arguments name, what they need, and where that is.
struct Packing {
    std::vector<fs::path> maps;
    VirtualFileSystem vfs;
    PackageSource source;
    EngineScripts scripts;
    MapNeeds needs;
    Exclusions exclusions;

    Packing(const StageContext &context, const PackOptions &options, const std::vector<fs::path> &given)
        : maps(given), vfs(OpenGameFiles(context.options, GameFolders(context.options, context.words, context.program),
                                         context.log, context.words)),
          source(vfs, FoldersOf(maps), options.basePaks),
          scripts(ReadScripts(source, *context.options.game, context.log)) {
        for (const fs::path &map : maps) {
            context.log.Print("Loading {}\n", map.string());
            AddNeeds(ReadBspFile(map, context.options.Format(), context.log), map.stem().string(),
                     *context.options.game, needs);
        }
        exclusions = LoadExclusions(context, options);
    }
};

void PrintList(std::string_view title, std::string_view sign, const std::vector<std::string> &lines, Log &log) {
    if (lines.empty())
        return;
    log.Print("{} {}:\n", lines.size(), title);
    for (const std::string &line : lines)
        log.Print("  {} {}\n", sign, line);
}

/// Prints what is missing, and returns the exit status.
int Finish(const PackagePlan &plan, RunReport &report, Log &log) {
    PrintList("not there, and not needed", "~fail", plan.absent, log);
    PrintList("missing", "!FAIL!", plan.missing, log);
    if (!plan.missing.empty())
        report.AddFault(Counted(plan.missing.size(), "files missing"));
    return plan.missing.empty() ? 0 : 1;
}

} // namespace

int PackStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    log.Section("Pk3");
    PackOptions options;
    TakeSettings(PackSettings(), options, arguments, log);
    const std::vector<fs::path> maps = MapsOf(TakeMaps(context, arguments), MapLists::Refuse);
    const std::string name = maps.back().stem().string();
    const fs::path folder = OutputFolder(context, options);
    const fs::path path = folder / (name + "_autopacked.pk3"), failed = folder / (name + "_FAILEDpack.pk3");
    const FileGuard files = GuardPackage({path, failed}, maps, context);
    Packing packing(context, options, maps);
    PackagePlan plan = MakePlan(packing.needs, packing.source, packing.scripts,
                                {.exclusions = packing.exclusions,
                                 .imageFiles = context.options.game->imageFiles,
                                 .png = options.png,
                                 .list = options.list},
                                log);
    for (const fs::path &map : packing.maps)
        AddMapFiles(map, packing.needs.externalPages, packing.source, plan);
    for (const fs::path &map : packing.maps)
        WarnOfBotFiles(map, packing.source, plan, log);
    files.CheckUnchanged();
    FileSet output;
    WritePackage(path, failed, options.level, packing.source, plan, output, log);
    return Finish(plan, context.report, log);
}

int RepackStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    log.Section("Repack");
    RepackOptions options;
    TakeSettings(RepackSettings(), options, arguments, log);
    const std::vector<fs::path> maps = MapsOf(TakeMaps(context, arguments), MapLists::Allow);
    const std::string name = maps.back().stem().string();
    const fs::path folder = options.onlyList ? fs::path() : OutputFolder(context, options);
    const fs::path path = folder / (name + "_repacked.pk3"), script = folder / (name + "_strippedBYrepacker.shader");
    const FileGuard files =
        GuardPackage(options.onlyList ? std::vector<fs::path>{} : std::vector{path, script}, maps, context);
    Packing packing(context, options, maps);
    if (const fs::path more = context.program.parent_path() / "repack.exclude"; fs::exists(more))
        packing.exclusions.Add(ReadExclusions(ReadTextFile(more), more.string()));
    PackagePlan plan = MakePlan(packing.needs, packing.source, packing.scripts,
                                {.exclusions = packing.exclusions,
                                 .imageFiles = context.options.game->imageFiles,
                                 .png = options.png,
                                 .wholeScripts = false,
                                 .list = true},
                                log);
    if (!options.onlyList) {
        files.CheckUnchanged();
        std::string text;
        for (const EngineShader *shader : plan.strippedShaders)
            text += '\n' + StrippedText(*shader);
        log.Print("Writing {}\n", script.string());
        FileSet output;
        output.AddText(script, text);
        WritePackage(path, path, options.level, packing.source, plan, output, log);
    }
    return Finish(plan, context.report, log);
}

// ---- q3map2 -shreport ----

namespace {

std::string PathInPackage(const fs::path &bspPath) {
    return fmt::format("maps/{}.bsp", bspPath.stem().string());
}

/// Places of the map, explained as its light run sees them: text of maps/x.explain.json.
std::string ExplainPlaces(Bsp bsp, const MapFiles &files, const LightRun &run, const VirtualFileSystem &vfs,
                          const SHReportOptions &options, const std::string &lightWords, const StageContext &context) {
    Log &log = context.log;
    WarnIfSourceIsNewer(files, log);
    LightInputs inputs = ReadLightInputs(files, log);
    RemoveMipmapHints(inputs.name, bsp); // as in the light stage: the .srf numbers surfaces without them
    inputs.vfs = &vfs;
    inputs.texLights = ReadTexLights(files, vfs, run, false, log);
    ShaderLibrary library = ShadersOfMap(bsp, run.options, vfs, *context.options.game, log);
    std::string text;
    WithExplainer(bsp, files, inputs, run, library, context, [&](const Explainer &explainer, const JobPool &jobs) {
        log.Section("Explain");
        const std::vector<PlaceInFront> places = PlacesInFrontOfSurfaces(explainer, std::size_t(options.places));
        text = ExplanationsJson(explainer, places, PathInPackage(files.bsp), lightWords, jobs, log);
        log.Count(places.size(), "places explained");
    });
    return text;
}

} // namespace

int SHReportStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    log.Section("SH report");
    const Game &game = *context.options.game;
    const SHReportOptions options = ParseSHReportOptions(arguments, log);
    const std::vector<std::string> given = arguments.Rest();
    const std::optional<LightRun> run =
        options.explain ? std::optional(TakeLightRun(arguments, game, log)) : std::optional<LightRun>();
    const StageFile file = TakeFile(context, arguments, given);
    const auto folders = GameFolders(context.options, context.words, context.program);
    const MapFiles files = FilesOfBsp(file.file);
    const fs::path &bspPath = files.bsp;
    PrintChangedOptions(arguments, log);
    const auto path =
        options.output.empty() ? WithExtension(bspPath, ".html") : std::filesystem::absolute(options.output);
    FileGuard guard(context);
    guard.Needs(bspPath);
    if (run)
        DeclareInputs(files, run->options, guard);
    guard.Writes(path, SizeOfFile(bspPath) / 4); // assumed: the map is packed
    if (options.textureSize > 0 || run)
        RequireGameFiles(context.options, folders, context.words, log);
    const VirtualFileSystem vfs = OpenGameFiles(context.options, folders, log, context.words);
    log.Print("Loading {}\n", bspPath.string());
    const Bsp bsp = ReadBspFile(bspPath, context.options.Format(), log);
    RequireFormatOfGame(bsp, bspPath, context.options);
    const std::string explanations = run ? ExplainPlaces(bsp, files, *run, vfs, options,
                                                         fmt::format("{}", fmt::join(file.wordsToRecord, " ")), context)
                                         : std::string();
    const std::filesystem::path folder = GameFolderOfMap(bspPath.string());
    const PackageSource source(vfs, folder.empty() ? std::vector<std::filesystem::path>{} : std::vector{folder}, {});
    const EngineScripts scripts = ReadScripts(source, game, log);
    const JobPool jobs(context.options.threads);
    const std::vector<std::byte> package =
        MakeReportPackage({bspPath, bsp, game, source, scripts, explanations}, options.textureSize, jobs, log);
    const std::string page = PageWithPackage(ViewerPage(), PathInPackage(bspPath), package);
    log.Print("Writing {}\n", path.string());
    ReplaceTextFile(path, page);
    log.Print("Wrote {} bytes, with a package of {} bytes\n", page.size(), package.size());
    return 0;
}

} // namespace q3
