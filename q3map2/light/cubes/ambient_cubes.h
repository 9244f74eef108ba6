// GPL-2.0-or-later. Ambient cubes of the leafs of a map.
#pragma once

#include "q3map2/bspfile/bspfile_cubes.h"
#include "q3map2/light/cubes/cube_sample.h"
#include "q3map2/light/grid/grid_pass.h"
#include "q3map2/light/sources/light_sources.h"

#include <optional>
#include <vector>

namespace q3 {

/// Samples of each leaf of a map. Leafs in solids, and those without an open place, have none.
using LeafCubes = std::vector<std::vector<CubeSample>>;

/// Light at up to options.cubesPerLeaf places of each leaf of a cluster. lights: from SetupEnvelopes for the SH grid,
/// without styles. `grid`: sides are taken from this SH grid; null: light is traced. Adds places to stats.points, leafs
/// with samples to stats.open.
LeafCubes SampleLeafs(const GridInputs &in, const std::vector<Light> &lights, const LightGridSH *grid,
                      GridStats &stats);

/// Thins out the samples, see ThinOutCubes, and stores them by leaf. With more than `most` of them the tolerance rises
/// until they fit, with a warning. Leafs without samples refer to the nearest leaf that has some and that they see, or
/// else to the nearest. Empty if no leaf has any. Errors: more leafs with samples than `most`.
std::optional<AmbientCubes> StoreCubes(const BspSpace &space, const LeafCubes &leafs, float tolerance,
                                       const JobPool &jobs, Log &log, std::size_t most = kMostCubes);

} // namespace q3
