// GPL-2.0-or-later. A picture of the light grids of a map.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"

#include <filesystem>

namespace q3 {

/// Renders the two light grids of `bsp`: a plan of the map, and pairs of spheres, lit by the SH grid and by the legacy
/// grid as engines do. Errors: no SH grid.
void WriteGridPreview(const std::filesystem::path &png, const Bsp &bsp, Log &log);

} // namespace q3
