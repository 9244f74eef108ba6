// GPL-2.0-or-later. What the stages that light a map, or explain its light, set up alike.
#include "q3map2/stages/light_run.h"

#include "common/files/files.h"
#include "q3map2/cli/global_options.h"
#include "q3map2/stages/light_files.h"

namespace q3 {

LightRun TakeLightRun(Arguments &arguments, const Game &game, Log &log) {
    LightRun run;
    run.options = ParseLightOptions(arguments, game, log);
    run.gridFormats = TakeGridFormats(run.options);
    run.lightmap = ParseLightmapOptions(arguments, run.options, game, log);
    return run;
}

void DeclareInputs(const std::filesystem::path &bspPath, const LightOptions &options, FileGuard &guard) {
    guard.Needs(bspPath);
    for (const std::string_view extension : {".map", ".srf", ".rad"})
        guard.Reads(Beside(bspPath, extension));
    for (const std::string &file : options.texLightFiles)
        guard.Reads(file);
}

ShaderLibrary ShadersOfMap(const Bsp &bsp, const LightOptions &options, const VirtualFileSystem &vfs, const Game &game,
                           Log &log) {
    ShaderLibrary library(vfs, game, options.shader, log);
    log.Count(library.DefinedCount(), "shaders defined");
    for (const bspShader_t &shader : bsp.shaders)
        library.SetDefaultFlags(FieldName(shader.shader), shader.surfaceFlags, shader.contentFlags);
    return library;
}

void WithExplainer(const Bsp &bsp, const std::filesystem::path &bspPath, const LightInputs &inputs, const LightRun &run,
                   ShaderLibrary &library, const StageContext &context,
                   const std::function<void(const Explainer &, const JobPool &)> &use) {
    const auto mapPath = Beside(bspPath, ".map");
    const std::string mapText = inputs.mapEntities ? ReadTextFile(mapPath) : std::string();
    const JobPool jobs(context.options.threads);
    use(Explainer(bsp, inputs, mapText, mapPath.filename().string(), run.options, run.lightmap, library,
                  *context.options.game, jobs, context.log),
        jobs);
}

} // namespace q3
