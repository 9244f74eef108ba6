// GPL-2.0-or-later. -deluxe: weights of light directions.
#pragma once

#include "libs/math/color.h"

#include <algorithm>

namespace q3 {

/// Weight of the direction from which light of this color, byte scale, arrives: 1 for white.
inline float DeluxeWeight(const Vec3f &color) {
    return std::max(0.0f, Luminance(color)) / 255;
}

/// Bounced light counts by this share of its weight: it comes from all over the hemisphere, so a direction stands for
/// little of it.
inline constexpr float kDeluxeBounceShare = 0.25f;

} // namespace q3
