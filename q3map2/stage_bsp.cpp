// GPL-2.0-or-later. q3map2 [-bsp]: a map source in, CompileMap, files out.
#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/bot_check.h"
#include "q3map2/bspfile/surface_keys.h"
#include "q3map2/command_record.h"
#include "q3map2/game_check.h"
#include "q3map2/geometry/compile_map.h"
#include "q3map2/geometry/game_entities.h"
#include "q3map2/geometry/map_text.h"
#include "q3map2/map/map_parse.h"
#include "q3map2/run_report.h"
#include "q3map2/stage_words.h"
#include "q3map2/tree/flood.h"

namespace q3 {

namespace {

namespace fs = std::filesystem;

void WriteText(const fs::path &path, const std::string &text, Log &log) {
    log.Print("Writing {}\n", path.string());
    ReplaceTextFile(path, text);
}

/// Path of the map source: extension `.map`, except for regions and for entities of -onlyents. Errors: a .bsp that may
/// have been meant for another stage, or that has no source.
fs::path SourcePath(const std::string &file, const BspOptions &options, bool stageGiven) {
    const fs::path path = fs::absolute(file), source = MapPath(file, ".map");
    const std::string extension = LowerCase(path.extension().string());
    const bool hasSource = fs::exists(source) || !options.tempName.empty();
    if (extension == ".bsp" && !stageGiven)
        throw Error("{} is a compiled map, which the bsp stage would replace; name a stage: -bsp compiles {}, -light "
                    "lights it, -vis computes what can be seen",
                    path.string(), source.filename().string());
    if (extension == ".bsp" && !hasSource && fs::exists(path))
        throw Error("{} is a compiled map and has no map source beside it: {} does not exist", path.string(),
                    source.string());
    if (extension == ".reg" || (extension == ".ent" && options.onlyEntities))
        return path;
    return source;
}

/// Removes files of an earlier run that this one might not overwrite.
void RemoveStaleFiles(const fs::path &source) {
    std::error_code ignored;
    for (const std::string_view extension : {".prt", ".lin"})
        fs::remove(Beside(source, extension), ignored);
    if (LowerCase(source.extension().string()) != ".reg")
        fs::remove(Beside(source, ".reg"), ignored);
}

Map ReadSource(const fs::path &source, const BspOptions &options, const BspContext &context) {
    const fs::path file = options.tempName.empty() ? source : fs::absolute(options.tempName);
    context.log.Print("Loading {}\n", file.string());
    return ReadMap(ReadTextFile(file), file.string(), context);
}

void WriteFiles(const fs::path &source, const CompiledMap &compiled, const BspContext &context,
                const BspFormat &format) {
    Log &log = context.log;
    if (!compiled.leakLine.empty())
        WriteLeakFile(Beside(source, ".lin"), compiled.leakLine);
    if (context.options.autoCaulk && !compiled.abandoned)
        WriteText(Beside(source, ".caulk"), compiled.caulkFile, log);
    if (compiled.abandoned || context.options.autoCaulk)
        return;
    if (!compiled.portalFile.empty())
        WriteText(Beside(source, ".prt"), compiled.portalFile, log);
    WriteText(Beside(source, ".srf"), compiled.surfaceFile, log);
    const fs::path path = Beside(source, ".bsp");
    const BotCheck bots(path, log);
    WriteBspFile(path, compiled.bsp, format, log);
    bots.Report(BotCheck::OtherGeometry, false);
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
    log.Count((long long)(ParseEntities(bsp.entities, "the entities").size()), "entities");
    log.Count((long long)(bsp.models.size()), "models");
    log.Count((long long)(bsp.brushes.size()), "brushes");
    log.Count((long long)(bsp.planes.size()), "planes");
    log.Count((long long)(bsp.nodes.size()), "nodes");
    log.Count((long long)(bsp.leafs.size()), "leafs");
    log.Count((long long)(bsp.drawSurfaces.size()), "draw surfaces");
    log.Count((long long)(bsp.drawVerts.size()), "vertices");
    log.Count((long long)(bsp.drawIndexes.size() / 3), "triangles");
    log.Count((long long)(bsp.shaders.size()), "shaders");
    log.Count((long long)(bsp.fogs.size()), "fogs");
}

void CompileToFiles(const fs::path &source, Map &map, const std::vector<std::string> &recorded,
                    const BspContext &context, const BspFormat &format) {
    Entity &world = map.World().pairs;
    PrintChangedKeys(world, keys::kWorldKeys, "worldspawn", context.log);
    RecordCommand(world, "-bsp", recorded);
    if (context.options.keepLights)
        world.Set(keys::kKeepLights.info.name, "1");
    if (context.options.keepModels)
        world.Set(keys::kKeepModels.info.name, "1");
    if (context.options.fakeMap)
        WriteText(fs::absolute("fakemap.map"), FakeMapText(map.World(), map.planes), context.log);
    const CompiledMap compiled = CompileMap(map, context);
    if (!compiled.abandoned && !context.options.autoCaulk)
        PrintCounts(compiled.bsp, context.log);
    WriteFiles(source, compiled, context, format);
}

} // namespace

int BspStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    const std::vector<std::string> given = arguments.Rest();
    log.Section("BSP");
    const BspOptions options = TakeOptions(context, arguments);
    const StageFile file = TakeFile(context, arguments, given);
    PrintChangedOptions(arguments, log);
    const fs::path source = SourcePath(file.file, options, context.stageGiven);
    const BspFormat format = context.options.Format();
    const auto folders = GameFolders(context.options, context.words, context.program);
    if (options.tempName.empty())
        RequireMap(source, folders);
    if (!options.onlyEntities)
        RequireGameFiles(context.options, folders, context.words, log);
    const VirtualFileSystem vfs = OpenGameFiles(context.options, folders, log);
    if (!options.onlyEntities)
        RemoveStaleFiles(source);
    ShaderLibrary library(vfs, *context.options.game, ShadersFor(options), log);
    log.Count((long long)(library.DefinedCount()), "shaders defined");
    const BspContext bspContext{
        .options = options, .game = *context.options.game, .shaders = library, .log = log, .vfs = &vfs};
    Map map = ReadSource(source, options, bspContext);
    if (options.onlyEntities) {
        const fs::path path = Beside(source, ".bsp");
        RequireMap(path);
        Bsp bsp = ReadBspFile(path, format, log);
        ReplaceEntities(bsp, map, bspContext);
        const BotCheck bots(path, log);
        WriteBspFile(path, bsp, format, log);
        bots.Report(BotCheck::SameGeometry, false);
    } else {
        CompileToFiles(source, map, file.recorded, bspContext, format);
    }
    if (!options.tempName.empty())
        fs::remove(fs::absolute(options.tempName));
    return 0;
}

} // namespace q3
