// GPL-2.0-or-later. Ambient cubes of the leafs of a map.
#pragma once

#include "q3map2/bspfile/bspfile_cubes.h"
#include "q3map2/light/cubes/cube_sample.h"
#include "q3map2/light/grid/grid_pass.h"
#include "q3map2/light/sources/light_sources.h"

#include <optional>
#include <vector>

namespace q3 {

/// Ambient cubes by leaf. Leafs in solids and leafs without an open place have none.
using LeafCubes = std::vector<std::vector<CubeSample>>;

/// Light at up to options.cubesPerLeaf places of each leaf that is in a cluster. lights: from SetupEnvelopes for the SH
/// grid, of style 0 only. grid: the SH grid to evaluate; null: light is traced. Adds the number of places to
/// stats.points, the number of leafs with samples to stats.open.
LeafCubes SampleLeafs(const GridInputs &in, const std::vector<Light> &lights, const LightGridSH *grid,
                      GridStats &stats);

/// Thins out the samples (ThinOutCubes) and stores them by leaf. If more than `most` samples are left, the tolerance is
/// raised until they fit, with a warning. A leaf without samples refers to the nearest leaf with samples that it sees,
/// or else to the nearest one. Empty if no leaf has samples. Errors: more leafs with samples than `most`.
std::optional<AmbientCubes> StoreCubes(const BspSpace &space, const LeafCubes &leafs, float tolerance,
                                       const JobPool &jobs, Log &log, std::size_t most = kMostCubes);

} // namespace q3
