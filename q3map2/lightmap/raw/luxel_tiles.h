// GPL-2.0-or-later. Mapped luxels in an order that keeps neighbors together.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

#include <algorithm>

namespace q3 {

/// Calls use(luxel, x, y) for all mapped luxels of the super grid, in tiles of `side` x `side` luxels, row by row of
/// tiles.
template <typename Use> void ForMappedLuxelsByTile(const RawLightmap &raw, int side, const Use &use) {
    const int width = raw.SuperWidth(), height = raw.SuperHeight();
    for (int top = 0; top < height; top += side)
        for (int left = 0; left < width; left += side)
            for (int y = top; y < std::min(top + side, height); ++y)
                for (int x = left; x < std::min(left + side, width); ++x)
                    if (const std::size_t luxel = raw.SuperIndex(x, y); raw.Mapped(luxel))
                        use(luxel, x, y);
}

} // namespace q3
