// GPL-2.0-or-later. What the stages that light a map, or explain its light, set up alike.
#pragma once

#include "common/arguments.h"
#include "q3map2/cli/program.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/gridformats/grid_formats.h"
#include "q3map2/lightmap/explain/explain.h"

#include <filesystem>
#include <functional>

namespace q3 {

/// The options of a light run.
struct LightRun {
    LightOptions options;
    GridFormats gridFormats;
    LightmapOptions lightmap;
};

/// Takes the options off `arguments`. Errors: those of their parsers.
LightRun TakeLightRun(Arguments &arguments, const Game &game, Log &log);

/// Declares the files that a light run reads.
void DeclareInputs(const std::filesystem::path &bspPath, const LightOptions &options, FileGuard &guard);

/// Scripts and images of the game, for the surfaces of the map. Keeps a reference to `vfs`.
ShaderLibrary ShadersOfMap(const Bsp &bsp, const LightOptions &options, const VirtualFileSystem &vfs, const Game &game,
                           Log &log);

/// Sets the light of a map up as its light run does, and hands it to `use`. Errors: those of Explainer.
void WithExplainer(const Bsp &bsp, const std::filesystem::path &bspPath, const LightInputs &inputs, const LightRun &run,
                   ShaderLibrary &library, const StageContext &context,
                   const std::function<void(const Explainer &, const JobPool &)> &use);

} // namespace q3
