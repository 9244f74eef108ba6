// GPL-2.0-or-later. q3map2 -recoverlights: the lamps of a lit map whose light entities are gone.
#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/cli/global_options.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/light/grid_bakes.h"
#include "q3map2/lightmap/light_stage.h"
#include "q3map2/lightmap/raw/lightmap_setup.h"
#include "q3map2/recover/recover_lights.h"
#include "q3map2/stages/light_files.h"
#include "q3map2/stages/stages.h"

#include <algorithm>

namespace q3 {

namespace {

/// Lamps that the table lists.
constexpr std::size_t kListed = 32;
/// More unexplained light than this is a warning. Byte scale.
constexpr double kMuchUnexplained = 6;

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

void PrintLamps(const RecoveredLights &found, Log &log) {
    log.Print("{:>8} {:>8} {:>8}  {:>8}  color\n", "x", "y", "z", "light");
    for (std::size_t i = 0; i < std::min(kListed, found.lamps.size()); ++i) {
        const Lamp &lamp = found.lamps[i];
        const Vec3f color = lamp.Color();
        log.Print("{:8.1f} {:8.1f} {:8.1f}  {:8.1f}  {:.2f} {:.2f} {:.2f}\n", lamp.origin.x, lamp.origin.y,
                  lamp.origin.z, lamp.Intensity(), color.x, color.y, color.z);
    }
    if (found.lamps.size() > kListed)
        log.Print("and {} weaker ones\n", found.lamps.size() - kListed);
}

} // namespace

int RecoverStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    log.Section("RecoverLights");
    const FilePlaces places = TakeFilePlaces("-recoverlights", arguments, log);
    const LightRun run = TakeLightRun(arguments, *context.options.game, log);
    WarnOfStoring(run, log);
    const StageFile file = TakeFile(context, arguments, {});
    const auto folders = GameFolders(context.options, context.words, context.program);
    const MapFiles files = FilesOfBsp(file.file, places, folders);
    const auto path = WithExtension(files.bsp, kRecoveredLights);
    FileGuard guard(context);
    DeclareInputs(files, run.options, guard);
    guard.Writes(path);
    if (std::filesystem::exists(path) && !context.options.force)
        throw Error("{} exists; -force replaces it", path.string());
    if (std::filesystem::exists(files.map))
        log.Warn("source next to the map", "-light reads the lights of {}, not those that are found here",
                 files.map.string());
    RequireGameFiles(context.options, folders, context.words, log);
    VirtualFileSystem vfs = OpenGameFiles(context.options, folders, log, context.words);
    log.Print("Loading {}\n", files.bsp.string());
    const Bsp bsp = ReadBspFile(files.bsp, context.options.Format(), log);
    if (bsp.lightmaps.empty())
        throw Error("{}: it has no lightmaps, from which lamps could be found", files.bsp.string());
    LightInputs inputs;
    inputs.name = files.bsp.stem().string();
    inputs.vfs = &vfs;
    if (std::filesystem::exists(files.srf))
        inputs.surfaceFile = ReadTextFile(files.srf);
    inputs.texLights = ReadTexLights(files, vfs, run.options.texLightFiles, run.lightmap.hdr, log);
    ShaderLibrary library = ShadersOfMap(bsp, run.options, vfs, *context.options.game, log);
    const JobPool jobs = context.report.Workers(context.options.threads);
    log.Count(jobs.Threads(), "threads");
    const LightSetup setup(bsp, inputs, run.options, SurfaceDefaultsOf(run.lightmap), library, log);
    SurfacePasses passes(setup, run.lightmap, jobs, log, {.keepLuxels = true});
    passes.Run();
    GridStats stats;
    const ObservedMap map = ObserveLight(bsp, setup, passes, LightLegacyGrid(setup, {}, jobs, log, stats));
    log.Section("Lamps");
    const RecoveredLights found = RecoverLights(map, setup, jobs, log);
    PrintLamps(found, log);
    log.Print("Light on luxels that known sources leave: {:.2f} bytes RMS; after {} lamps: {:.2f}\n", found.rmsBefore,
              found.lamps.size(), found.rmsAfter);
    if (found.rmsAfter > kMuchUnexplained)
        log.Warn("much light unexplained",
                 "lamps leave {:.1f} bytes RMS of the light on luxels unexplained; if the map was lit with options "
                 "such as -gamma, -compensate or -dirty, give them here too",
                 found.rmsAfter);
    guard.CheckUnchanged();
    FileSet written;
    written.AddText(path, LampEntities(found.lamps));
    written.AddLine(log, fmt::format("Writing {}\n", path.string()));
    written.Commit();
    return 0;
}

} // namespace q3
