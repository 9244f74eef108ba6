// GPL-2.0-or-later. Inputs and statistics of a pass over a light grid.
#pragma once

#include "common/jobs.h"
#include "common/log.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/light/grid/indirect_light.h"
#include "q3map2/light/grid/light_floodlight.h"
#include "q3map2/light/scene/light_scene.h"
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/sources/light_entities.h"
#include "q3map2/light/transfer/contribution_counts.h"

namespace q3 {

/// Everything that a grid pass reads.
struct GridInputs {
    const BspSpace &space;
    const LightScene &scene;
    const LightOptions &options;
    const WorldLight &world;
    const JobPool &jobs;
    Log &log;
    const IndirectLight *indirect = nullptr; ///< bounced light, or null
    /// For FloodShare.
    std::vector<Vec3f> floodDirections = FloodDirections(options.lowQuality);
};

/// Counts of points and of the work to light them.
struct GridStats {
    std::int64_t points = 0;
    std::int64_t open = 0;           ///< lit in place or a small step beside; legacy grid: all points that are lit
    std::int64_t moved = 0;          ///< in a solid, lit from the nearest point in the open
    std::int64_t filled = 0;         ///< in a solid, interpolated from lit neighbors
    std::uint64_t skippedFaint = 0;  ///< brick and light pairs left out: too faint to matter
    std::uint64_t skippedReach = 0;  ///< brick and light pairs out of reach
    std::uint64_t skippedPvs = 0;    ///< brick and light pairs hidden by visibility data
    std::uint64_t skippedSmooth = 0; ///< points and samples whose weak light is interpolated
    ContributionCounts counts;
    double seconds = 0;
    void Add(const GridStats &o);
    void Print(Log &log) const;
};

} // namespace q3
