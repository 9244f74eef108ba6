// GPL-2.0-or-later. Bakes of a map, to compare with the reference.
#pragma once

#include "common/files/vfs.h"
#include "q3map2/light/light_setup.h"
#include "q3map2/lightmap/raw/lightmaps.h"
#include "tools/measure/shbench/lightmap_passes.h"

#include <memory>

namespace q3::bounce {

/// A compiled map and the inputs of its lighting.
struct MeasuredMap {
    const VirtualFileSystem &files;
    const Game &game;
    Bsp bsp;
    LightInputs inputs;
    Log &log;
};

/// What is measured: it decides which options the reference supports. Options that sample or blur within luxels change
/// direct light, so the reference of bounced light does without them; they are settings of direct light to measure.
enum class MeasuredLight { Direct, Bounced };

/// The map, its shaders with images and its lights, for one set of options. Keeps a reference to the files.
class MapSetup {
  public:
    /// Errors: as LightWorld; options that the reference does not support.
    MapSetup(const MeasuredMap &map, const bench::LightmapSettings &settings,
             MeasuredLight measured = MeasuredLight::Bounced);
    MapSetup(const MapSetup &) = delete;
    MapSetup &operator=(const MapSetup &) = delete;

    const bench::LightmapSettings settings;

  private:
    std::unique_ptr<ShaderLibrary> library_; // made before `light`, which refers to it

  public:
    const LightSetup light;
};

/// Words of light options without -bounce and its number, a blank after each. Bakes for which they are equal share
/// their direct light.
std::string OptionsWithoutBounces(std::string_view options);

/// Light of style 0 by raw lightmap and luxel, after all passes. Byte scale; red below 0: not used.
struct BakedLuxels {
    std::vector<std::vector<Vec3f>> light;
    double cpuSeconds = 0; ///< of all passes over surfaces
};
/// Runs the passes over surfaces with that number of bounces. `surfaces`, if given, receives their final state.
BakedLuxels BakeLuxels(const MapSetup &map, int bounces, const JobPool &jobs, Log &log,
                       SurfaceLight *surfaces = nullptr);

/// A copy of the map with an SH grid.
struct BakedGrid {
    Bsp bsp;
    double cpuSeconds = 0; ///< of the grid alone
};
/// Lights the SH grid with bounced light, or with direct light alone for 0 bounces.
BakedGrid BakeGrid(const MeasuredMap &map, bench::LightmapSettings settings, int bounces, const JobPool &jobs);

} // namespace q3::bounce
