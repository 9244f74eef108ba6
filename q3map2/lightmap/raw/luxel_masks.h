// GPL-2.0-or-later. One byte for each luxel.
#pragma once

#include <cstdint>
#include <vector>

namespace q3 {

/// A byte for each luxel of a lightmap, row by row: not 0 where something holds.
using LuxelMask = std::vector<std::uint8_t>;

/// Whether it holds for the luxel or one of its up to 8 neighbours: what looks for those can leave out the others.
/// `mask` has width * height bytes.
LuxelMask Spread(const LuxelMask &mask, int width, int height);

} // namespace q3
