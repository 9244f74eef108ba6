// GPL-2.0-or-later. What the stages share that light a map or explain its light: the files beside it, the options of a
// light run, light that relighting loses, and the size of SH grids.
#pragma once

#include "common/arguments.h"
#include "common/files/vfs.h"
#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/cli/program.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/gridformats/grid_formats.h"
#include "q3map2/light/light_setup.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/lightmap/explain/explain.h"
#include "q3map2/lightmap/options/lightmap_options.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

namespace q3 {

/// Ends of the names of files that -recoverlights writes, in place of .bsp: the lamps, factors of the light that
/// shaders emit, and light that both leave unexplained.
inline constexpr std::string_view kRecoveredLights = ".lights.map", kRecoveredSources = ".lights.rad",
                                  kUnexplainedLight = ".unexplained.json";

/// The .map and the .srf of a map, if they exist; without a .map, the lights that -recoverlights found. Errors: Error,
/// for files that cannot be read or parsed.
LightInputs ReadLightInputs(const MapFiles &files, Log &log);

/// Warns of luxel sizes on the command line (`given`) that the .srf overrides, and removes them from the list of
/// changed options.
void WarnOfLuxelSizes(const std::vector<std::string> &given, const LightInputs &inputs, Arguments &arguments, Log &log);

/// The formats that the light stage stores: those of -gridformats, and the SH grid, uniform or sparse, if an option
/// that includes it is given. None without -gridformats. Turns the legacy grid of the bake off if one of them replaces
/// it, and the sparse one on if one of them is that. Errors: those of ParseGridFormats, -shpreview without an SH grid
/// in the file.
GridFormats TakeGridFormats(LightOptions &options);

/// After a bake: stores the formats and writes their files to `folder`, maps/x. Without formats, drops grids of earlier
/// runs from the map.
void StoreBakedGrids(const GridFormats &formats, const LightOptions &options, const std::filesystem::path &folder,
                     Bsp &bsp, const JobPool &jobs, FileSet &written, Log &log);

/// Writes files of the formats to `folder`, maps/x. Warns of a raw file that is there from an earlier run, if engines
/// would take it for that of this map.
void AddGridFiles(const std::filesystem::path &folder, const std::vector<GridFile> &files, FileSet &written, Log &log);

/// Compares the legacy light grid of a map before and after it is lit. Compilers usually leave light entities out of
/// the .bsp, so lighting it again without its .map gives less light.
class LostLightCheck {
  public:
    explicit LostLightCheck(const Bsp &bsp);
    /// After lighting: warns if the map has no light entities, or those that were `recovered`, and its grid less than
    /// 2/3 of the light before. Errors: less than 1/2; with `force` (-force), that is a warning too.
    void Report(const Bsp &bsp, bool recovered, bool force, Log &log) const;

  private:
    double before_; ///< mean light of the grid before
};

/// Warns of each lump of light in the map that a run with these options neither keeps nor makes again. `formats`: of
/// -gridformats.
void WarnOfDroppedLight(const Bsp &bsp, const LightOptions &options, const LightmapOptions &lightmap,
                        const GridFormats &formats, Log &log);

/// Estimate of the size of `data` after deflate at its usual level, from up to 1 MB of it in evenly spaced pieces.
/// Bytes.
std::uint64_t EstimateDeflated(std::span<const std::byte> data, const JobPool &jobs = JobPool(1));

/// Prints points, size and zipped size of the SH grids of a map that was just written, and a cell that would halve
/// those of the uniform one. Warns when the grid is more than half of the file and over 1 MB, and its cells are smaller
/// than those of -shsmall, so that this option helps. `fileBytes`: of the .bsp.
void PrintGridSHSize(const Bsp &bsp, std::uint64_t fileBytes, const JobPool &jobs, Log &log);

// ---- A light run ----

/// The options of a light run.
struct LightRun {
    LightOptions options;
    GridFormats gridFormats;
    LightmapOptions lightmap;
};

/// The texlights of a map: lights.rad among the game's files, the files of -lights, the .rad of the map, and, unless
/// -recoverlights is about to write it, that of an earlier -recoverlights; in this order. hdr: see TexLights::Read.
/// Errors: Error, if one of `given` does not exist or a file cannot be read.
TexLights ReadTexLights(const MapFiles &files, const VirtualFileSystem &vfs, const LightRun &run, bool recovers,
                        Log &log);

/// Takes the options off `arguments`. Errors: those of their parsers.
LightRun TakeLightRun(Arguments &arguments, const Game &game, Log &log);

/// Declares the files that a light run reads.
void DeclareInputs(const MapFiles &files, const LightOptions &options, FileGuard &guard);

/// Scripts and images of the game, for the surfaces of the map. Keeps a reference to `vfs`.
ShaderLibrary ShadersOfMap(const Bsp &bsp, const LightOptions &options, const VirtualFileSystem &vfs, const Game &game,
                           Log &log);

/// Sets the light of a map up as its light run does, and hands it to `use`. Errors: those of Explainer.
void WithExplainer(const Bsp &bsp, const MapFiles &files, const LightInputs &inputs, const LightRun &run,
                   ShaderLibrary &library, const StageContext &context,
                   const std::function<void(const Explainer &, const JobPool &)> &use);

} // namespace q3
