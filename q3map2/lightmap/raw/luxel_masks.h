// GPL-2.0-or-later. Masks of luxels.
#pragma once

#include <cstdint>
#include <vector>

namespace q3 {

/// A byte for each luxel of a lightmap, row by row; not 0: set.
using LuxelMask = std::vector<std::uint8_t>;

/// Dilation by 3 x 3: not 0 where the mask is set for the luxel or one of its up to 8 neighbors. `mask` has
/// width * height bytes.
LuxelMask Dilate(const LuxelMask &mask, int width, int height);

} // namespace q3
