// GPL-2.0-or-later. Masks of luxels.
#include "q3map2/lightmap/raw/luxel_masks.h"

#include <algorithm>
#include <cstddef>

namespace q3 {

LuxelMask Dilate(const LuxelMask &mask, int width, int height) {
    const auto w = std::size_t(std::max(width, 0));
    LuxelMask spread(mask.size()), row(w + 2); // with a zero column on either side
    for (int y = 0; y < height; ++y) {
        const std::uint8_t *own = mask.data() + std::size_t(y) * w;
        const std::uint8_t *above = y > 0 ? own - w : own, *below = y + 1 < height ? own + w : own;
        for (std::size_t x = 0; x < w; ++x)
            row[x + 1] = std::uint8_t(above[x] | own[x] | below[x]);
        std::uint8_t *to = spread.data() + std::size_t(y) * w;
        for (std::size_t x = 0; x < w; ++x)
            to[x] = std::uint8_t(row[x] | row[x + 1] | row[x + 2]);
    }
    return spread;
}

} // namespace q3
