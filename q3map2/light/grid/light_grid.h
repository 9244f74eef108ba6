// GPL-2.0-or-later. The two light grids: placement and light at every point.
#pragma once

#include "common/jobs.h"
#include "q3map2/light/grid/indirect_light.h"
#include "q3map2/light/transfer/light_contribution.h"

#include <vector>

namespace q3 {

/// Everything that a grid pass reads.
struct GridInputs {
    const BspSpace &space;
    const LightScene &scene;
    const LightOptions &options;
    const WorldLight &world;
    const JobPool &jobs;
    Log &log;
    const IndirectLight *indirect = nullptr; ///< bounced light; null without
};

/// Shares of a finished grid and the work it took.
struct GridStats {
    std::int64_t points = 0;
    std::int64_t open = 0;          ///< lit where they stand, or at most a small step beside
    std::int64_t moved = 0;         ///< in a solid, lit from the nearest open place
    std::int64_t filled = 0;        ///< in a solid, interpolated from lit neighbours
    std::uint64_t skippedFaint = 0; ///< brick and light pairs left out: too faint to matter
    std::uint64_t skippedReach = 0; ///< out of reach
    std::uint64_t skippedPvs = 0;   ///< out of sight
    ContributionCounts counts;
    double seconds = 0;
    void Add(const GridStats &o);
    void Print(Log &log, bool verbose) const;
};

/// Cell size of the legacy grid: worldspawn gridsize or 64 64 128, at least 8, enlarged until at most 1048576 points;
/// writes a changed size back to `world`.
GridLayout SetupGrid(const Bsp &bsp, Entity &world, Log &log);
/// The legacy light grid.
std::vector<bspGridPoint_t> TraceGrid(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
                                      GridStats &stats);

/// SH grid: -gridsh or the legacy cell size divided by -gridscalesh, at least 8, enlarged until the lump stays under
/// 2^31 bytes.
GridLayout SetupGridSH(const Bsp &bsp, const Float3 &legacySize, const LightOptions &options, Log &log);
/// The SH light grid: every point in the open lit exactly, points in solids next to the open filled, all others zero.
LightGridSH TraceGridSH(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
                        GridStats &stats);

/// Share of the hemisphere around +z or -z (up: +1 or -1) that is open within `distance`, 0 to 1; spec of floodlight.
float FloodShare(const LightScene &scene, const Vec3f &p, float up, float distance, bool lowQuality, RayCounts &counts);

} // namespace q3
