// GPL-2.0-or-later. The SH grids of a map as libs/shgrid, the reader of engines, samples them.
#pragma once

#include "libs/shgrid/shgrid.h"
#include "q3map2/bspfile/bsp.h"

#include <cstddef>
#include <span>

namespace q3 {

/// A reader of the uniform grid, which must outlive it.
shgrid_grid UniformReader(const LightGridSH &grid);
/// A reader of the lump of a sparse grid (EncodeSparseGrid), which must outlive it. Errors: what shgrid_parse says.
shgrid_grid SparseReader(std::span<const std::byte> lump);

} // namespace q3
