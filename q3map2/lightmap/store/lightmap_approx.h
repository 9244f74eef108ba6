// GPL-2.0-or-later. -approx: lightmaps that vertex colors can replace.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Whether vertex colors replace a lightmap.
enum class VertexStandIn {
    No,
    Forced, ///< yes: the surfaces are at most 2 luxels large
    Close   ///< yes: interpolated vertex colors are within -approx of the lightmap, in bytes
};

/// By raw lightmap. All No without -approx.
std::vector<VertexStandIn> FindVertexStandIns(const SurfaceInputs &in, const SurfaceLight &surfaces);

} // namespace q3
