// GPL-2.0-or-later. q3map2 [-bsp]: a map source in, CompileMap, files out.
#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"
#include "q3map2/bspfile/map_keys.h"
#include "q3map2/cli/global_options.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/edit/bot_files.h"
#include "q3map2/geometry/compile_map.h"
#include "q3map2/geometry/emit/game_entities.h"
#include "q3map2/map/map_parse.h"
#include "q3map2/report/run_report.h"
#include "q3map2/stages/geometry_cache.h"
#include "q3map2/stages/stage_cache.h"
#include "q3map2/stages/stages.h"
#include "q3map2/stages/written_map.h"
#include "q3map2/tree/flood.h"

#include <array>

namespace q3 {

namespace {

namespace fs = std::filesystem;

void WriteText(const fs::path &path, const std::string &text, Log &log) {
    log.Print("Writing {}\n", path.string());
    ReplaceTextFile(path, text);
}

/// Path of the map source: extension `.map`, except for regions and for entities of -onlyents. Errors: a .bsp that may
/// have been meant for another stage, or that has no source.
fs::path SourcePath(const std::string &file, const BspOptions &options, bool stageIsNamed) {
    const fs::path path = fs::absolute(file), source = MapPath(file, ".map");
    const std::string extension = LowerCase(path.extension().string());
    const bool hasSource = fs::exists(source) || !options.tempName.empty();
    if (extension == ".bsp" && !stageIsNamed)
        throw Error("{} is a compiled map, which the bsp stage would replace; name a stage: -bsp compiles {}, -light "
                    "lights it, -vis computes what can be seen",
                    path.string(), source.filename().string());
    if (extension == ".bsp" && !hasSource && fs::exists(path))
        throw Error("{} is a compiled map without a map source next to it: {} does not exist", path.string(),
                    source.string());
    if (extension == ".reg" || (extension == ".ent" && options.onlyEntities))
        return path;
    return source;
}

/// Removes files of an earlier compile that do not belong to the files that are written: a map that `leaks` has a leak
/// line and no portals.
void RemoveStaleFiles(const fs::path &source, const MapFiles &files, bool leaks, FileSet &written) {
    written.AddRemoval(leaks ? files.prt : files.lin);
    if (LowerCase(source.extension().string()) != ".reg")
        written.AddRemoval(Beside(source, ".reg"));
}

/// The source that is read: with -tempname not the one that the outputs are named after.
fs::path FileOfSource(const fs::path &source, const BspOptions &options) {
    return options.tempName.empty() ? source : fs::absolute(options.tempName);
}

/// Names the files of the stage. A .bsp is assumed to have at least half the size of its source.
FileGuard GuardFiles(const fs::path &source, const MapFiles &files, const BspOptions &options,
                     const StageContext &context) {
    FileGuard guard(context);
    const fs::path file = FileOfSource(source, options), &bsp = files.bsp;
    RequireDistinct(std::array{source, files.bsp, files.srf, files.prt, files.lin});
    guard.Needs(file);
    if (options.autoCaulk) {
        guard.Writes(Beside(source, ".caulk"));
        return guard;
    }
    guard.Reads(bsp);
    guard.Writes(bsp, options.onlyEntities ? SizeOfFile(bsp) : SizeOfFile(file) / 2);
    if (!options.onlyEntities)
        for (const fs::path &written : {files.srf, files.prt, files.lin})
            guard.Writes(written);
    return guard;
}

struct LoadedSource {
    std::string text;
    Map map;
};

LoadedSource ReadSource(const fs::path &source, const BspOptions &options, const BspContext &context) {
    const fs::path file = FileOfSource(source, options);
    context.log.Print("Loading {}\n", file.string());
    std::string text = ReadTextFile(file);
    Map map = ReadMap(text, file.string(), context);
    return {std::move(text), std::move(map)};
}

void AddBsp(const fs::path &path, const Bsp &bsp, const BspFormat &format, FileSet &files, Log &log) {
    log.Print("Writing {}\n", path.string());
    try {
        const std::vector<std::byte> bytes = WriteBsp(bsp, format);
        files.Add(path).Append(bytes);
        files.AddLine(log, fmt::format("Wrote {} ({} bytes)\n", SizeText(bytes.size()), bytes.size()));
    } catch (const Error &error) {
        const std::string text = error.what();
        throw Error("{}", text.starts_with(path.string()) ? text : fmt::format("{}: {}", path.string(), text));
    }
}

/// Writes the files of a compile together: if one cannot be written, all old files stay.
void WriteFiles(const fs::path &source, const MapFiles &files, const CompiledMap &compiled, const FileGuard &guard,
                const BspContext &context, const BspFormat &format) {
    Log &log = context.log;
    guard.CheckUnchanged();
    FileSet written;
    const auto add = [&](const fs::path &path, const std::string &text) {
        log.Print("Writing {}\n", path.string());
        written.AddText(path, text);
    };
    const bool leaks = !compiled.leakLine.empty();
    if (leaks)
        written.AddText(files.lin, LeakFileText(compiled.leakLine));
    if (context.options.autoCaulk && !compiled.abandoned)
        add(Beside(source, ".caulk"), compiled.caulkFile);
    if (compiled.abandoned || context.options.autoCaulk)
        return written.Commit();
    if (!compiled.portalFile.empty())
        add(files.prt, compiled.portalFile);
    add(files.srf, compiled.surfaceFile);
    const BotCheck bots(files.bsp, log);
    AddBsp(files.bsp, compiled.bsp, format, written, log);
    RemoveStaleFiles(source, files, leaks, written);
    written.Commit();
    WarnOfEngineMemory(files.bsp, compiled.bsp, context.game, log);
    bots.Report(BotCheck::OtherGeometry, BotCheck::OnlyWarn);
}

BspOptions TakeOptions(const StageContext &context, Arguments &arguments) {
    BspOptions options = ParseBspOptions(arguments, *context.options.game, context.log);
    options.subdivisions = context.options.subdivisions;
    options.maxDrawSurfaces = context.options.maxDrawSurfaces;
    return options;
}

ShaderOptions ShadersFor(const BspOptions &options) {
    ShaderOptions shader;
    shader.imageSizes = true;
    shader.sRgbColor = options.sRgbColor;
    shader.customInfoParms = options.customInfoParms;
    shader.noOb = options.noOb;
    shader.globalFlags = options.globalFlags;
    return shader;
}

/// What the map is made of.
void PrintCounts(const Bsp &bsp, Log &log) {
    log.Count(ParseEntities(bsp.entities, "the entities").size(), "entities");
    log.Count(bsp.models.size(), "models");
    log.Count(bsp.brushes.size(), "brushes");
    log.Count(bsp.planes.size(), "planes");
    log.Count(bsp.nodes.size(), "nodes");
    log.Count(bsp.leafs.size(), "leafs");
    log.Count(bsp.drawSurfaces.size(), "draw surfaces");
    log.Count(bsp.drawVerts.size(), "vertices");
    log.Count(bsp.drawIndexes.size() / 3, "triangles");
    log.Count(bsp.shaders.size(), "shaders");
    log.Count(bsp.fogs.size(), "fogs");
}

/// What the last line of the run says.
void AddFaults(const CompiledMap &compiled, const BspContext &context, RunReport &report) {
    if (!compiled.leakLine.empty())
        report.AddFault(fmt::format("the map leaks ({})", context.leakFile));
    if (compiled.idleAreaPortals > 0)
        report.AddFault(Counted(compiled.idleAreaPortals, "areaportals without effect"));
}

/// recorded: words of the command line that the .bsp keeps.
CompiledMap Compile(LoadedSource &loaded, const std::vector<std::string> &recorded, GeometryCache cache,
                    const BspContext &context) {
    Map &map = loaded.map;
    Entity &world = map.World().pairs;
    PrintChangedKeys(world, keys::kWorldKeys, "worldspawn", context.log);
    RecordCommand(world, "-bsp", recorded);
    if (context.options.keepLights)
        world.Set(keys::kKeepLights.info.name, "1");
    if (context.options.keepModels)
        world.Set(keys::kKeepModels.info.name, "1");
    if (context.options.fakeMap)
        WriteText(fs::absolute("fakemap.map"), FakeMapText(map.World(), map.planes), context.log);
    CompiledMap compiled = cache.Compile(map, loaded.text, context);
    if (!compiled.abandoned && !context.options.autoCaulk)
        PrintCounts(compiled.bsp, context.log);
    return compiled;
}

void ReplaceStoredEntities(const fs::path &path, Map &map, const FileGuard &guard, const BspContext &context,
                           const BspFormat &format) {
    RequireMap(path);
    Bsp bsp = ReadBspFile(path, format, context.log);
    if (bsp.ident != format.ident)
        throw Error("{}: a map of the format {}, but the game has {}: give the game that it is for with -game",
                    path.string(), bsp.ident, format.ident);
    ReplaceEntities(bsp, map, context);
    guard.CheckUnchanged();
    const BotCheck bots(path, context.log);
    WriteBspFile(path, bsp, format, context.log);
    bots.Report(BotCheck::SameGeometry, BotCheck::OnlyWarn);
}

} // namespace

int BspStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    log.Section("BSP");
    const FilePlaces places = TakeFilePlaces("-bsp", arguments, log);
    const std::vector<std::string> given = arguments.Rest();
    const BspOptions options = TakeOptions(context, arguments);
    const StageFile file = TakeFile(context, arguments, given);
    PrintChangedOptions(arguments, log);
    const fs::path source = SourcePath(file.file, options, context.stageIsNamed);
    const BspFormat format = context.options.Format();
    const auto folders = GameFolders(context.options, context.words, context.program);
    if (options.tempName.empty())
        RequireMap(source, folders);
    const MapFiles files = FilesOf(source, places);
    const FileGuard guard = GuardFiles(source, files, options, context);
    if (!options.onlyEntities)
        RequireGameFiles(context.options, folders, context.words, log);
    VirtualFileSystem vfs = OpenGameFiles(context.options, folders, log, context.words);
    StageCache cache(context, file.wordsToRecord,
                     {.guard = guard, .moreInputs = BotFilesBeside(files.bsp), .moreOutputs = {}, .vfs = &vfs});
    if (cache.Restore()) {
        FileSet stale;
        RemoveStaleFiles(source, files, fs::exists(files.lin), stale);
        stale.Commit();
        return 0;
    }
    ShaderLibrary library(vfs, *context.options.game, ShadersFor(options), log);
    log.Count(library.DefinedCount(), "shaders defined");
    const BspContext bspContext{.options = options,
                                .game = *context.options.game,
                                .shaders = library,
                                .log = log,
                                .vfs = &vfs,
                                .leakFile = files.lin.string()};
    LoadedSource loaded = ReadSource(source, options, bspContext);
    bool done = true; // false: -leaktest found a leak
    if (options.onlyEntities) {
        ReplaceStoredEntities(files.bsp, loaded.map, guard, bspContext, format);
    } else {
        const CompiledMap compiled = Compile(loaded, file.wordsToRecord, {cache, vfs, format}, bspContext);
        AddFaults(compiled, bspContext, context.report);
        WriteFiles(source, files, compiled, guard, bspContext, format);
        done = !compiled.abandoned;
    }
    if (!options.tempName.empty())
        fs::remove(fs::absolute(options.tempName));
    if (done)
        cache.Store();
    return done ? 0 : 1;
}

} // namespace q3
