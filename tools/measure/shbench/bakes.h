// GPL-2.0-or-later. Settings under test: what a bake costs and what it shows.
#pragma once

#include "tools/measure/shbench/bench_map.h"
#include "tools/measure/shbench/errors.h"

#include <optional>
#include <string>
#include <vector>

namespace q3::bench {

/// A named list of light options.
struct BakeSetting {
    std::string name, options;
};
/// The setting of --bake "NAME: LIGHT OPTIONS". Errors: no name, or no colon.
BakeSetting ParseBakeSetting(const std::string &text);

/// What one bake took.
struct BakeCost {
    double cpuSeconds = 0;   ///< the whole call, all threads
    double setUpSeconds = 0; ///< part of it before the first grid point
    std::uint64_t rays = 0;
    std::int64_t points = 0;    ///< with a value in the lump
    std::int64_t litPoints = 0; ///< of these: traced, not filled or empty
    std::int64_t bytes = 0;     ///< of the lump
};

/// A lit copy of a map.
struct Baked {
    Bsp bsp;
    BakeCost cost;
};

/// What a bake makes and shows.
enum class BakedFormat { GridSH, SparseGridSH, NamedGridSH, LegacyGrid, AmbientCubes };
/// The format that these options ask for; GridSH if none.
BakedFormat FormatOf(const LightOptions &options);

/// Lights a copy of the map in process, for that format alone. Errors: as LightWorld.
Baked Bake(const BenchMap &map, const LightOptions &options, BakedFormat format, ShaderLibrary &library,
           const JobPool &jobs);

/// What an engine shows with that format of a lit map, which must outlive it. Errors: the map has no such light.
ShownLight ShownBy(BakedFormat format, const Bsp &bsp);

} // namespace q3::bench
