// GPL-2.0-or-later. Lightmaps that vertex colours can stand for.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

enum class VertexStandIn {
    No,
    Forced, ///< the surfaces are hardly larger than a luxel
    Close   ///< colours interpolated between vertices are within -approx of the lightmap's
};

/// By raw lightmap. All No without -approx.
std::vector<VertexStandIn> FindVertexStandIns(const SurfaceInputs &in, const SurfaceLight &surfaces);

} // namespace q3
