// GPL-2.0-or-later. Reports how many bytes the SH grid takes in a .bsp, plain and zipped.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace q3 {

/// Estimate of the size of `data` after deflate at level 9, from up to 4 MB of it in evenly spaced pieces. Bytes.
std::uint64_t EstimateDeflated(std::span<const std::byte> data);

/// Prints points, size and zipped size of the SH grids of a map that was just written, and a cell that would halve
/// those of the uniform one. Warns when the grid is more than half of the file and over 1 MB, and its cells are smaller
/// than those of -shsmall, so that this option helps. `fileBytes`: of the .bsp.
void PrintGridSHSize(const Bsp &bsp, std::uint64_t fileBytes, Log &log);

} // namespace q3
