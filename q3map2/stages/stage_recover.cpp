// GPL-2.0-or-later. q3map2 -recoverlights: the lamps of a lit map whose light entities are gone.
#include "q3map2/cli/global_options.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/stages/light_files.h"
#include "q3map2/stages/recovered_lamps.h"
#include "q3map2/stages/stages.h"
#include "q3map2/stages/written_map.h"

namespace q3 {

namespace {

/// Options of -light that only say what it stores change nothing here.
void WarnOfStoring(const LightRun &run, Log &log) {
    const LightOptions &options = run.options;
    const LightmapOptions &lightmap = run.lightmap;
    if (options.sh || options.shAdaptive || options.shLights || options.ambientCubes || options.staticPropLighting ||
        !run.gridFormats.empty() || !options.explain.empty() || !options.previewFile.empty() || lightmap.onlyGrid ||
        lightmap.external || lightmap.exportPages || lightmap.lightmass || lightmap.hdr)
        log.Warn("options without effect",
                 "options that say what -light stores, such as -sh or -external, change nothing here: no light is "
                 "stored");
}

/// Adds the map with lamps among its entities to `written`.
void AddMapWithLamps(const RecoverInputs &in, const RecoveredLights &found, const std::filesystem::path &path,
                     const BspFormat &format, FileSet &written) {
    Bsp bsp = in.bsp;
    bsp.entities = FormatEntities(EntitiesWithLamps(in, found.lamps));
    AddBspFile(path, bsp, format, written, in.log);
}

} // namespace

int RecoverStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    log.Section("RecoverLights");
    const FilePlaces places = TakeFilePlaces("-recoverlights", arguments, log);
    RecoverOptions own;
    TakeSettings(RecoverSettings(), own, arguments, log);
    const bool isGiven = arguments.Rest().size() > 1; // options of -light, before the file
    LightRun run = TakeLightRun(arguments, *context.options.game, log);
    WarnOfStoring(run, log);
    const StageFile file = TakeFile(context, arguments, {});
    const auto folders = GameFolders(context.options, context.words, context.program);
    const MapFiles files = FilesOfBsp(file.file, places, folders);
    FileGuard guard(context);
    DeclareInputs(files, run.options, guard);
    GuardRecoveredLamps(context, files, guard);
    if (own.insert)
        guard.Writes(files.bsp, SizeOfFile(files.bsp));
    if (std::filesystem::exists(files.map))
        log.Warn("source next to the map", "-light reads the lights of {}, not those that are found here",
                 files.map.string());
    RequireGameFiles(context.options, folders, context.words, log);
    VirtualFileSystem vfs = OpenGameFiles(context.options, folders, log, context.words);
    log.Print("Loading {}\n", files.bsp.string());
    const BspFormat format = context.options.Format();
    const Bsp bsp = ReadBspFile(files.bsp, format, log);
    if (!isGiven)
        run = RecordedLightRun(bsp, context);
    LightInputs inputs = ReadLightInputs(files, log);
    inputs.seeksLamps = true;
    inputs.vfs = &vfs;
    inputs.texLights = ReadTexLights(files, vfs, run, true, log);
    ShaderLibrary library = ShadersOfMap(bsp, run.options, vfs, *context.options.game, log);
    const JobPool jobs = context.report.Workers(context.options.threads);
    log.Count(jobs.Threads(), "threads");
    const RecoverInputs in{bsp, inputs, run.options, run.lightmap, library, ImagesFor(run), jobs, log};
    FileSet written;
    const RecoveredLights found = FindLamps(in, files, written);
    guard.CheckUnchanged();
    if (!own.insert) {
        written.Commit();
        return 0;
    }
    const BotCheck bots(files.bsp, log);
    AddMapWithLamps(in, found, files.bsp, format, written);
    written.Commit();
    bots.Report(BotCheck::SameGeometry, BotCheck::OnlyWarn);
    return 0;
}

} // namespace q3
