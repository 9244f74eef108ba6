// GPL-2.0-or-later. How far apart two lights are on a screen.
#pragma once

#include "libs/sh/sh.h"
#include "q3map2/light/sparse/lattice_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

/// Squared difference of what is displayed on a surface, mean over all normals and the channels, bytes^2: the basis is
/// orthonormal, so that is the squared distance of the coefficients over 4 pi. A screen shows at most 1: the difference
/// counts less where the reference is brighter, by the square of kBright times its mean.
inline float DisplayError(const ShFloats &light, const ShFloats &reference) {
    constexpr float kBright = 2.2f, kScale = 255 * 255 / (3 * 4 * std::numbers::pi_v<float>);
    float sum = 0;
    for (std::size_t i = 0; i < kShFloats; ++i)
        sum += (light[i] - reference[i]) * (light[i] - reference[i]);
    const float mean = float(kShC0) * std::max({reference[0], reference[1], reference[2]});
    const float beyond = std::max(1.0f, kBright * mean);
    return sum * kScale / (beyond * beyond);
}

} // namespace q3
