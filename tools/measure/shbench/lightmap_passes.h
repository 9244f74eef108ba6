// GPL-2.0-or-later. CPU time and rays of lightmaps and vertex light, pass by pass, compared with bare Embree.
#pragma once

#include "q3map2/lightmap/options/lightmap_options.h"
#include "tools/measure/shbench/bench_map.h"

#include <cstdint>
#include <string>
#include <vector>

namespace q3::bench {

/// A part of the light stage.
struct LightmapPass {
    std::string name; ///< as the light stage prints it
    double cpuSeconds = 0;
    std::uint64_t rays = 0;
};

/// Options of -light, parsed.
struct LightmapSettings {
    LightOptions light;
    LightmapOptions lightmap;
};

/// Options of -light as words, split at blanks. Errors: words that it does not know.
LightmapSettings LightmapSettingsFrom(std::string_view text, const Game &game);

/// Lights lightmaps and vertices of copies of the map, without grids, `repeats` times. For each pass, in order: the
/// least CPU time, summed over all threads. Errors: as LightWorld.
std::vector<LightmapPass> LightmapPasses(const BenchMap &map, const LightmapSettings &settings, ShaderLibrary &library,
                                         const JobPool &jobs, int repeats);

/// The passes and their sum as a table, and the passes as JSON. rawPerSecond: rays of bare Embree, see
/// EmbreeThroughput; 0: not measured.
std::string LightmapPassTable(const std::vector<LightmapPass> &passes, double rawPerSecond);
std::string LightmapPassJson(const std::vector<LightmapPass> &passes, double rawPerSecond);

} // namespace q3::bench
