// GPL-2.0-or-later. q3map2 -light: files in, LightWorld, file out.
#include "common/error.h"
#include "q3map2/bot_check.h"
#include "q3map2/bspfile/light_keys.h"
#include "q3map2/bspfile/light_style_keys.h"
#include "q3map2/command_record.h"
#include "q3map2/convert/preview/grid_preview.h"
#include "q3map2/game_check.h"
#include "q3map2/grid_format_files.h"
#include "q3map2/grid_size_report.h"
#include "q3map2/light_inputs.h"
#include "q3map2/lightmap/light_world.h"
#include "q3map2/lightmap/props/prop_files.h"
#include "q3map2/lightmap/store/hdr_store.h"
#include "q3map2/lightmap/store/lightmap_pages.h"
#include "q3map2/lightmap/store/lightmap_scripts.h"
#include "q3map2/lost_light_check.h"
#include "q3map2/run_report.h"
#include "q3map2/stage_words.h"

namespace q3 {

namespace {

struct PagesFiles {
    std::filesystem::path bsp, folder;
};

PagesFiles FindPages(const StageContext &context, Arguments &arguments) {
    const auto bsp = ExistingBsp(TakeFile(context, arguments, {}).file);
    return {bsp, WithExtension(bsp, "")};
}

void PrintWorldKeys(const Entity &world, Log &log) {
    PrintChangedKeys(world, keys::kWorldLightKeys, "worldspawn", log);
    PrintChangedKeys(world, keys::kStyleWorldKeys, "worldspawn", log);
    PrintChangedKeys(world, keys::kMacroKeys, "worldspawn", log);
}

} // namespace

int LightStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    const std::vector<std::string> given = arguments.Rest();
    log.Section("Light");
    LightOptions options = ParseLightOptions(arguments, *context.options.game, log);
    const GridFormats gridFormats = TakeGridFormats(options);
    const LightmapOptions lightmap = ParseLightmapOptions(arguments, options, *context.options.game, log);
    const StageFile file = TakeFile(context, arguments, given);
    const auto folders = GameFolders(context.options, context.words, context.program);
    const auto bspPath = ExistingBsp(file.file, folders);
    LightInputs inputs = ReadLightInputs(bspPath, log);
    WarnOfLuxelSizes(given, inputs, arguments, log);
    PrintChangedOptions(arguments, log);

    RequireGameFiles(context.options, folders, context.words, log);
    const VirtualFileSystem vfs = OpenGameFiles(context.options, folders, log);
    log.Print("Loading {}\n", bspPath.string());
    const BspFormat format = context.options.Format();
    Bsp bsp = ReadBspFile(bspPath, format, log);
    inputs.vfs = &vfs;
    inputs.texLights = ReadTexLights(bspPath, vfs, options.texLightFiles, lightmap.hdr, log);
    const Entity world = StoredEntities(bsp.entities, inputs.name).front();
    PrintWorldKeys(world, log);
    if (!lightmap.onlyGrid)
        RemoveMipmapHints(inputs.name, bsp);

    ShaderLibrary library(vfs, *context.options.game, options.shader, log);
    log.Count((long long)(library.DefinedCount()), "shaders defined");
    for (const bspShader_t &shader : bsp.shaders)
        library.SetDefaultFlags(FieldName(shader.shader), shader.surfaceFlags, shader.contentFlags);
    const JobPool jobs(context.options.threads);
    log.Count(jobs.Threads(), "threads");
    const LostLightCheck lostLight(bsp);
    LightResult result = LightWorld(bsp, inputs, options, lightmap, library, jobs, log);
    lostLight.Report(bsp, log);
    const auto folder = WithExtension(bspPath, "");
    StoreBakedGrids(gridFormats, options, folder, bsp, jobs, log);
    RecordCommand(bsp, "-light", inputs.name, file.recorded);
    if (bsp.gridSH && bsp.gridSHContainer == GridSHContainer::Lump && !format.advertisements && format.version == 46)
        log.Print("The SH grid makes this a version 47 file, which engines without SH support refuse; -shbspx keeps "
                  "version 46\n");
    if (!lightmap.onlyGrid) {
        FinishForFile(lightmap, inputs.name, result.lightmaps, bsp);
        const auto pages = lightmap.externalFolder.empty() ? folder : std::filesystem::path(lightmap.externalFolder);
        WritePages(pages, result.lightmaps, log);
        WriteHdrFiles(pages, lightmap, result.lightmaps, log);
        WriteLightmass(pages, inputs.name, result.lightmaps.lightmass, log);
        WriteScript(ScriptPath(bspPath, *context.options.game), result.lightmaps, log);
    }
    if (options.staticPropFiles)
        WritePropFiles(folder, result.props, log);
    const BotCheck bots(bspPath, log);
    WriteBspFile(bspPath, bsp, format, log);
    bots.Report(BotCheck::SameGeometry, options.fixBotFiles);
    PrintGridSHSize(bsp, std::filesystem::file_size(bspPath), log);
    if (lightmap.exportPages && !lightmap.external)
        ExportLightmaps(bsp, lightmap.gamePageSize[0], folder, log);
    if (!options.previewFile.empty())
        WriteGridPreview(options.previewFile, bsp, log);
    return 0;
}

int ExportStage(const StageContext &context, Arguments arguments) {
    const ExportOptions options = ParseExportOptions(arguments, context.log);
    const PagesFiles files = FindPages(context, arguments);
    const Bsp bsp = ReadBspFile(files.bsp, context.options.Format(), context.log);
    ExportLightmaps(bsp, context.options.game->lightmapSize, files.folder, context.log, options);
    return 0;
}

int ImportStage(const StageContext &context, Arguments arguments) {
    const ExportOptions options = ParseExportOptions(arguments, context.log);
    const PagesFiles files = FindPages(context, arguments);
    const BspFormat format = context.options.Format();
    Bsp bsp = ReadBspFile(files.bsp, format, context.log);
    ImportLightmaps(bsp, context.options.game->lightmapSize, files.folder, context.log, options);
    WriteBspFile(files.bsp, bsp, format, context.log);
    return 0;
}

} // namespace q3
