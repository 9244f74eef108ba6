// GPL-2.0-or-later. q3map2 -vis: the .bsp and its .prt in, visibility data into the .bsp.
#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/bspfile/map_keys.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/edit/bot_files.h"
#include "q3map2/report/run_report.h"
#include "q3map2/stages/stage_cache.h"
#include "q3map2/stages/stages.h"
#include "q3map2/stages/written_map.h"
#include "q3map2/vis/vis.h"
#include "q3map2/vis/vis_parts.h"

#include <algorithm>
#include <optional>
#include <system_error>

namespace q3 {

namespace {

/// Errors: no file, with the likely reason and what to do.
void CheckPrtExists(const MapFiles &files) {
    const std::filesystem::path &prtPath = files.prt, &leakPath = files.lin;
    if (std::filesystem::exists(prtPath))
        return;
    if (std::filesystem::exists(leakPath))
        throw Error("{} is missing, because the map leaked: {} shows where, load it in the editor, close the leak and "
                    "compile the map again",
                    prtPath.string(), leakPath.string());
    throw Error("{} is missing, which the bsp stage writes for a map without leaks, and -vis deletes: compile the map "
                "again, and use -saveprt to run -vis more than once",
                prtPath.string());
}

void CheckClusters(const Bsp &bsp, const std::filesystem::path &bspPath, const PortalFile &portals,
                   const std::filesystem::path &prtPath) {
    int clusters = 0;
    for (const bspLeaf_t &leaf : bsp.leafs)
        clusters = std::max(clusters, leaf.cluster + 1);
    if (clusters != portals.clusters)
        throw Error("{}:2: {} clusters, expected the {} of {}; compile the map again", prtPath.string(),
                    portals.clusters, clusters, bspPath.string());
}

void RemovePrt(const std::filesystem::path &path, Log &log) {
    std::error_code failed;
    if (!std::filesystem::remove(path, failed) && failed)
        log.Warn("file not removed", "{}: cannot be removed: {}", path.string(), failed.message());
}

/// Of everything that the visibility depends on.
Hash128 HashOfInputs(const std::filesystem::path &prtPath, const Entity &world, const UnitStore &units) {
    KeyBuilder key("vis");
    key.Add(units.settings.low, units.settings.high);
    const Hash128 portals = HashOf(ReadFile(prtPath));
    key.Add(portals.low, portals.high);
    key.AddText(keys::kFarPlaneDist.Text(world));
    return key.Key();
}

} // namespace

int VisStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    log.Section("Vis");
    const FilePlaces places = TakeFilePlaces("-vis", arguments, log);
    const PartOptions parts = TakePartOptions(arguments, log);
    const std::vector<std::string> given = arguments.Rest();
    VisStageOptions options = ParseVisOptions(arguments, log);
    const StageFile file = TakeFile(context, arguments, given);
    PrintChangedOptions(arguments, log);
    const MapFiles files = FilesOfBsp(file.file, places);
    const std::filesystem::path &bspPath = files.bsp, &prtPath = files.prt;

    FileGuard guard(context);
    guard.Needs(bspPath);
    guard.Reads(prtPath);
    if (!parts.file.empty())
        guard.Writes(parts.file);
    if (!parts.part)
        guard.Writes(bspPath, SizeOfFile(bspPath));
    WarnIfSourceIsNewer(files, log); // by dates, which no entry of the cache depends on
    std::optional<const RunUnits> units;
    if (parts.Any()) // the cache keeps the output as a whole
        units.emplace(context, file.wordsToRecord, parts, bspPath);
    UnitStore *const store = units ? units->Store() : nullptr;
    StageCache cache(context, file.wordsToRecord,
                     {.guard = guard, .moreInputs = BotFilesBeside(bspPath), .moreOutputs = {prtPath}});
    if (cache.Restore())
        return 0;
    log.Print("Loading {}\n", bspPath.string());
    Bsp bsp = ReadBspFile(bspPath, context.options.Format(), log);
    const BspFormat format = FormatOfMap(bsp, bspPath, context.options);
    CheckPrtExists(files);
    log.Print("Loading {}\n", prtPath.string());
    const PortalFile portals = ReadPortalFile(prtPath);
    log.Print("{:6} portalclusters\n{:6} numportals\n{:6} numfaces\n", portals.clusters, portals.portals.size(),
              portals.faces.size());
    if (portals.portals.empty()) {
        log.Print("No portals means no vis, exiting.\n");
        return 0;
    }
    CheckClusters(bsp, bspPath, portals, prtPath);
    const std::string name = bspPath.string();
    RecordCommand(bsp, "-vis", name, file.wordsToRecord);
    const Entity world = StoredEntities(bsp.entities, name).front();
    options.vis.farPlane = FarPlaneOf(world);

    const JobPool jobs = context.report.Workers(context.options.threads);
    if (store && options.vis.flowRounds == 0)
        options.vis.flowRounds = kFlowRoundsOfParts;
    if (store) {
        store->Begin(HashOfInputs(prtPath, world, *store));
        store->endsWithFile = !parts.part && EndsWithFile(parts, *store, PartRounds(options.vis));
        if (store->endsWithFile && store->roundsBefore > 1) {
            WritePartFile(parts, *store, "-vis", name, log);
            return 0;
        }
    }
    const std::optional<Visibility> visibility =
        ComputeVisibility(portals, prtPath.string(), options.vis, store, jobs, log);
    if (!visibility) {
        guard.CheckUnchanged();
        WritePartFile(parts, *store, "-vis", name, log);
        return 0;
    }
    PrintStatistics(*visibility, options.histogram, log);
    bsp.visibility = visibility->Lump();
    guard.CheckUnchanged();
    const BotCheck bots(bspPath, log);
    WriteBspFile(bspPath, bsp, format, log);
    bots.Report(BotCheck::SameGeometry, BotCheck::OnlyWarn);
    if (!options.savePrt)
        RemovePrt(prtPath, log);
    cache.Store();
    return 0;
}

} // namespace q3
