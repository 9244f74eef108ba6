// GPL-2.0-or-later. Validation of compiled maps.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"

#include <string_view>

namespace q3 {

/// Checks that every index, count and float is in range. ReadBsp calls it; call it for a Bsp from any other source.
/// Not checked, because valid files break it: bounds of nodes and leafs, an even count of planes, finite texture and
/// lightmap coordinates of vertices, lightmapNum and lightmap rectangle (a warning), entity text that parses (a
/// warning), a light grid of the expected length (a warning).
void ValidateBsp(const Bsp &bsp, std::string_view name, Log &log);

} // namespace q3
