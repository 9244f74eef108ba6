// GPL-2.0-or-later. The BSPX lump LIGHTGRID_OCTREE: light without direction.
#pragma once

#include "q3map2/bspfile/bspx.h"
#include "q3map2/gridformats/grid_source.h"
#include "q3map2/gridformats/grid_tone.h"

#include <cstddef>
#include <vector>

namespace q3 {

/// The points of the SH grid, each with the mean of its light over all normals; those that are void are occluded.
/// Errors: all are.
std::vector<std::byte> EncodeOctreeLump(const GridSource &source, const GridTone &tone);

} // namespace q3
