// GPL-2.0-or-later. The BSPX lump LIGHTGRIDS: light on six sides.
#pragma once

#include "q3map2/bspfile/bspx.h"
#include "q3map2/gridformats/grid_source.h"
#include "q3map2/gridformats/grid_tone.h"

#include <cstddef>
#include <vector>

namespace q3 {

/// One subgrid with the points of the SH grid, each with its light on surfaces that face +x, -x, +y, -y, +z, -z; black
/// sides are left out, and void points are occluded. Errors: all points are void, the lump would pass 2^32 bytes.
std::vector<std::byte> EncodeGridsLump(const GridSource &source, const GridTone &tone);

} // namespace q3
