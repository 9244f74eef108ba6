// GPL-2.0-or-later. The plainest baker of an SH grid, to compare with.
#pragma once

#include "tools/measure/shbench/bakes.h"

namespace q3::bench {

/// Same points as `layout`. At each point that is not in solid or void, every light is traced by one ray toward its
/// center; area lights count as points with the emitter's cosine. Nothing is skipped and nothing filled: other points
/// are zero.
Baked BakeBaseline(const BenchMap &map, const bspGridSHHeader_t &layout, const JobPool &jobs);

} // namespace q3::bench
