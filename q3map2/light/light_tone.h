// GPL-2.0-or-later. Float light to stored bytes.
#pragma once

#include "q3map2/light/light_options.h"

#include <array>
#include <cstdint>

namespace q3 {

/// The established program's chain: scale, contrast, gamma, exposure, saturation, compensation, hue-preserving limit,
/// sRGB, truncation. `color` on the byte scale. A scale or brightness of 0 or less counts as 1.
std::array<std::uint8_t, 3> ColorToBytes(const Vec3f &color, float scale, float brightness, const ToneOptions &tone);

} // namespace q3
