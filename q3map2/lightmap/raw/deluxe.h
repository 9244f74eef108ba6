// GPL-2.0-or-later. -deluxe: weights of light directions.
#pragma once

#include "libs/math/color.h"

#include <algorithm>

namespace q3 {

/// Weight of the direction from which light of this color, byte scale, arrives: 1 for white.
inline float DeluxeWeight(const Vec3f &color) {
    return std::max(0.0f, Luminance(color)) / 255;
}

/// Bounced light counts by this share of its weight: it comes from the whole hemisphere, so its mean direction
/// says little.
inline constexpr float kDeluxeBounceShare = 0.25f;

} // namespace q3
