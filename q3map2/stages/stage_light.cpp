// GPL-2.0-or-later. q3map2 -light: files in, LightWorld, file out.
#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/bspfile/light_keys.h"
#include "q3map2/cli/global_options.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/convert/preview/grid_preview.h"
#include "q3map2/edit/bot_files.h"
#include "q3map2/edit/edit_lumps.h"
#include "q3map2/lightmap/explain/explain_report.h"
#include "q3map2/lightmap/light_stage.h"
#include "q3map2/lightmap/store/hdr_store.h"
#include "q3map2/lightmap/store/lightmap_pages.h"
#include "q3map2/lightmap/store/lightmap_scripts.h"
#include "q3map2/lightmap/vertex/prop_lighting.h"
#include "q3map2/report/run_report.h"
#include "q3map2/stages/light_files.h"
#include "q3map2/stages/recovered_lamps.h"
#include "q3map2/stages/stage_cache.h"
#include "q3map2/stages/stages.h"
#include "q3map2/stages/written_map.h"

#include <algorithm>

namespace q3 {

namespace {

/// The files of -export and -import.
struct LightmapFiles {
    std::filesystem::path bsp, folder; ///< the map, and the folder of its lightmap images
};

LightmapFiles TakeLightmapFiles(const StageContext &context, Arguments &arguments) {
    const auto bsp = ExistingBsp(TakeFile(context, arguments, {}).file);
    return {bsp, WithExtension(bsp, "")};
}

/// Names the files of the light stage. Free space for the .bsp is checked later, when the size of its grid is known.
FileGuard GuardLight(const MapFiles &files, const LightOptions &options, const LightmapOptions &lightmap,
                     const PartOptions &parts, const StageContext &context) {
    const std::filesystem::path &bspPath = files.bsp;
    FileGuard guard(context);
    DeclareInputs(files, options, guard);
    if (!options.explain.empty())
        return guard;
    if (!parts.file.empty())
        guard.Writes(parts.file);
    if (parts.part)
        return guard;
    guard.Writes(bspPath);
    if (!lightmap.externalFolder.empty())
        guard.WritesInto(lightmap.externalFolder);
    else if (lightmap.external || lightmap.exportPages || lightmap.lightmass || lightmap.hdrFiles != HdrFiles::None ||
             options.staticPropFiles)
        guard.WritesInto(WithExtension(bspPath, ""));
    if (!options.previewFile.empty())
        guard.Writes(options.previewFile);
    return guard;
}

/// Bytes of the uniform SH grid that the options ask for; 0: none, or its layout is invalid.
std::uint64_t EstimateGridSH(const Bsp &bsp, const LightOptions &options) {
    if (!options.sh || bsp.models.empty())
        return 0;
    try {
        constexpr float kLeastScale = 1e-3f; // chosen: keeps the cell of a tiny -gridscalesh finite
        const Vec3f scaled = Vec3f(GridCellOf(StoredEntities(bsp.entities, "the map").front())) *
                             float(1 / std::max(options.gridScaleSH, kLeastScale));
        const Vec3f cell = options.gridSizeSH.value_or(scaled);
        const bspModel_t &world = bsp.models.front();
        return std::uint64_t(LayoutGrid(world.mins, world.maxs, cell.Array()).Count()) * sizeof(bspGridPointSH_t);
    } catch (const Error &) { // the light stage says what is wrong
        return 0;
    }
}

/// -explain: prints the reports. The map and all files stay as they are.
void ExplainPoints(const Bsp &bsp, const MapFiles &files, const LightInputs &inputs, const LightRun &run,
                   ShaderLibrary &library, const StageContext &context) {
    WithExplainer(bsp, files, inputs, run, library, context, [&](const Explainer &explainer, const JobPool &) {
        for (const Vec3f &p : run.options.explain) {
            context.log.Section("Explanation");
            context.log.Print("{}", ReportOf(explainer.Explain(p)));
        }
    });
    context.log.Print("Only explained: {} stays as it is\n", files.bsp.string());
}

/// Files that a run may write or remove besides those of GuardLight.
std::vector<std::filesystem::path> MoreOutputs(const std::filesystem::path &bspPath, const LightOptions &options,
                                               const Game &game) {
    std::vector<std::filesystem::path> files{ScriptPath(bspPath, game)};
    if (options.fixBotFiles)
        for (const std::filesystem::path &file : BotFilesBeside(bspPath))
            files.push_back(file);
    return files;
}

/// -recoverlights: finds the lamps of a map, and sets the entities and texlights of `inputs` to what was found.
void RecoverLamps(const StageContext &context, const Bsp &bsp, const MapFiles &files, const LightRun &run,
                  ShaderLibrary &library, const JobPool &jobs, LightInputs &inputs, FileSet &written) {
    const LightRun lit = RecordedLightRun(bsp, context);
    inputs.seeksLamps = true;
    const RecoverInputs in{
        bsp, inputs, lit.options, lit.lightmap, library, std::max(ImagesFor(lit), ImagesFor(run)), jobs, context.log};
    const RecoveredLights found = FindLamps(in, files, written);
    inputs.mapEntities = SourceOfLamps(in, found.lamps);
    inputs.texLights = found.sources;
    inputs.seeksLamps = false;
    context.log.Section("Light, with these lamps");
}

/// With the map source there are no lamps to find.
void CheckRecovery(const PartOptions &parts, const MapFiles &files, LightOptions &options, Log &log) {
    if (!options.recoverLamps)
        return;
    if (parts.Any() || !options.explain.empty())
        throw Error("-recoverlights does not go with -part, -join and -explain; run it as a stage first");
    if (!std::filesystem::exists(files.map))
        return;
    log.Warn("source next to the map", "{} has the lights of the map, so -recoverlights has no effect",
             files.map.string());
    options.recoverLamps = false;
}

void PrintWorldKeys(const Entity &world, Log &log) {
    PrintChangedKeys(world, keys::kWorldLightKeys, "worldspawn", log);
    PrintChangedKeys(world, keys::kStyleWorldKeys, "worldspawn", log);
    PrintChangedKeys(world, keys::kMacroKeys, "worldspawn", log);
}

} // namespace

int LightStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    log.Section("Light");
    const FilePlaces places = TakeFilePlaces("-light", arguments, log);
    const PartOptions parts = TakePartOptions(arguments, log);
    const std::vector<std::string> given = arguments.Rest();
    LightRun run = TakeLightRun(arguments, *context.options.game, log);
    const auto &[options, gridFormats, lightmap] = run;
    const StageFile file = TakeFile(context, arguments, given);
    const auto folders = GameFolders(context.options, context.words, context.program);
    const MapFiles files = FilesOfBsp(file.file, places, folders);
    const std::filesystem::path &bspPath = files.bsp;
    CheckRecovery(parts, files, run.options, log);
    FileGuard guard = GuardLight(files, options, lightmap, parts, context);
    if (options.recoverLamps)
        GuardRecoveredLamps(context, files, guard);
    LightInputs inputs = ReadLightInputs(files, log);
    WarnOfLuxelSizes(given, inputs, arguments, log);
    PrintChangedOptions(arguments, log);

    RequireGameFiles(context.options, folders, context.words, log);
    VirtualFileSystem vfs = OpenGameFiles(context.options, folders, log, context.words);
    const bool onlyExplains = !options.explain.empty();
    WarnIfSourceIsNewer(files, log); // by dates, which no entry of the cache depends on
    StageCache cache(context, file.wordsToRecord,
                     {.guard = guard,
                      .moreInputs = BotFilesBeside(bspPath),
                      .moreOutputs = MoreOutputs(bspPath, options, *context.options.game),
                      .vfs = &vfs});
    if (!onlyExplains && !options.recoverLamps && !parts.Any() && cache.Restore())
        return 0;
    const RunUnits units(context, file.wordsToRecord, parts, bspPath);
    if (units.Store())
        vfs.RecordRequests();
    const int rounds = HasSecondRound(options, lightmap) ? 2 : 1;
    if (parts.Any() && !parts.part && EndsWithFile(parts, *units.Store(), rounds)) {
        WritePartFile(parts, *units.Store(), "-light", bspPath.string(), log);
        return 0;
    }
    log.Print("Loading {}\n", bspPath.string());
    const BspFormat format = context.options.Format();
    Bsp bsp = ReadBspFile(bspPath, format, log);
    RequireFormatOfGame(bsp, bspPath, context.options);
    if (format.HasStyleSlots())
        run.lightmap.UsePageSize(bsp.lightmapSide);
    if (!onlyExplains && !parts.part) {
        WarnOfDroppedLight(bsp, options, lightmap, gridFormats, log);
        guard.Writes(bspPath, SizeOfFile(bspPath) + EstimateGridSH(bsp, options));
    }
    inputs.vfs = &vfs;
    inputs.texLights = ReadTexLights(files, vfs, run, options.recoverLamps, log);
    const Entity world = StoredEntities(bsp.entities, inputs.name).front();
    PrintWorldKeys(world, log);
    if (!lightmap.onlyGrid)
        RemoveMipmapHints(inputs.name, bsp);

    ShaderLibrary library = ShadersOfMap(bsp, options, vfs, *context.options.game, log);
    if (onlyExplains) {
        ExplainPoints(bsp, files, inputs, run, library, context);
        return 0;
    }
    const JobPool jobs = context.report.Workers(context.options.threads);
    log.Count(jobs.Threads(), "threads");
    const LostLightCheck lostLight(bsp);
    FileSet written; // together: a map never has the images or the lamps of another run
    if (options.recoverLamps)
        RecoverLamps(context, bsp, files, run, library, jobs, inputs, written);
    inputs.units = units.Store();
    LightResult result = LightWorld(bsp, inputs, options, lightmap, library, jobs, log);
    if (parts.part) {
        guard.CheckUnchanged();
        WritePartFile(parts, *inputs.units, "-light", bspPath.string(), log);
        return 0;
    }
    lostLight.Report(bsp, options.recoverLamps, context.options.force, log);
    guard.CheckUnchanged();
    const auto folder = WithExtension(bspPath, "");
    StoreBakedGrids(gridFormats, options, folder, bsp, jobs, written, log);
    RecordCommand(bsp, "-light", inputs.name, file.wordsToRecord);
    if (bsp.gridSH && bsp.gridSHContainer == GridSHContainer::Lump && !format.advertisements && format.version == 46)
        log.Print("The SH grid makes this a version 47 file, which engines without SH support refuse; -shbspx keeps "
                  "version 46\n");
    if (!lightmap.onlyGrid) {
        FinishForFile(lightmap, inputs.name, result.lightmaps, bsp);
        const auto pages = lightmap.externalFolder.empty() ? folder : std::filesystem::path(lightmap.externalFolder);
        AddPages(pages, result.lightmaps, written, log);
        AddHdrFiles(pages, lightmap, result.lightmaps, written, log);
        AddLightmass(pages, inputs.name, result.lightmaps.lightmass, written, log);
        AddScript(ScriptPath(bspPath, *context.options.game), result.lightmaps, written, log);
    }
    if (options.staticPropFiles)
        AddPropFiles(folder, result.props, written, log);
    const BotCheck bots(bspPath, log);
    const std::uint64_t size = AddBspFile(bspPath, bsp, format, written, log);
    written.Commit();
    bots.Report(BotCheck::SameGeometry, options.fixBotFiles ? BotCheck::FixFiles : BotCheck::OnlyWarn);
    PrintGridSHSize(bsp, size, jobs, log);
    WarnOfEngineLimits(bspPath, bsp, *context.options.game, log);
    if (lightmap.exportPages && !lightmap.external)
        ExportLightmaps(bsp, lightmap.gamePageSize[0], folder, log);
    if (!options.previewFile.empty())
        WriteGridPreview(options.previewFile, bsp, log);
    units.Keep(vfs);
    if (!options.recoverLamps) // which is not in the cache
        cache.Store();
    return 0;
}

int ExportStage(const StageContext &context, Arguments arguments) {
    const ExportOptions options = ParseExportOptions(arguments, context.log);
    const LightmapFiles files = TakeLightmapFiles(context, arguments);
    FileGuard guard(context);
    guard.Needs(files.bsp);
    guard.WritesInto(files.folder, SizeOfFile(files.bsp) / 4); // assumed: lightmaps are a quarter of a lit map
    const Bsp bsp = ReadBspFile(files.bsp, context.options.Format(), context.log);
    ExportLightmaps(bsp, bsp.lightmapSide, files.folder, context.log, options);
    return 0;
}

int ImportStage(const StageContext &context, Arguments arguments) {
    const ExportOptions options = ParseExportOptions(arguments, context.log);
    const LightmapFiles files = TakeLightmapFiles(context, arguments);
    FileGuard guard(context);
    guard.Needs(files.bsp);
    guard.Writes(files.bsp, SizeOfFile(files.bsp));
    Bsp bsp = ReadBspFile(files.bsp, context.options.Format(), context.log);
    const BspFormat format = FormatOfMap(bsp, files.bsp, context.options);
    ImportLightmaps(bsp, bsp.lightmapSide, files.folder, context.log, options);
    guard.CheckUnchanged();
    const BotCheck bots(files.bsp, context.log);
    WriteBspFile(files.bsp, bsp, format, context.log);
    bots.Report(BotCheck::SameGeometry, BotCheck::OnlyWarn);
    return 0;
}

} // namespace q3
