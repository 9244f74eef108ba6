// GPL-2.0-or-later. Settings under test: what a bake costs and what it shows.
#pragma once

#include "tools/shbench/bench_map.h"
#include "tools/shbench/errors.h"

#include <optional>
#include <string>
#include <vector>

namespace q3::bench {

/// A named list of light options.
struct BakeSetting {
    std::string name, options;
};

/// What one bake took.
struct BakeCost {
    double cpuSeconds = 0;   ///< the whole call, all threads
    double setUpSeconds = 0; ///< part of it before the first grid point
    std::uint64_t rays = 0;
    std::int64_t points = 0;
    std::int64_t litPoints = 0; ///< traced, not filled or empty
    std::int64_t bytes = 0;     ///< of the lump
};

struct Baked {
    Bsp bsp;
    BakeCost cost;
};

/// Lights a copy of the map in process. `sh`: the SH grid alone, else the legacy grid alone. Errors: as LightWorld.
Baked Bake(const BenchMap &map, LightOptions options, bool sh, ShaderLibrary &library, const JobPool &jobs);

/// What an engine shows with the SH or the legacy grid of a lit map, which must outlive it. Errors: no such grid.
ShownLight ShownBySH(const Bsp &bsp);
ShownLight ShownByLegacy(const Bsp &bsp);

} // namespace q3::bench
