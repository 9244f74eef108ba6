// GPL-2.0-or-later. How far apart two lights are on a screen.
#pragma once

#include "libs/sh/sh.h"
#include "q3map2/light/sparse/lattice_points.h"

#include <algorithm>
#include <bit>
#include <numbers>

namespace q3 {

/// Coefficients of displayed light, convolved with the cosine, of stored ones, which are that unless `radiance`.
inline ShFloats ToDisplayed(const bspGridPointSH_t &stored, bool radiance) {
    auto light = std::bit_cast<ShFloats>(stored);
    for (std::size_t i = 0; radiance && i < kShFloats; ++i)
        light[i] *= float(kCosineLobe[i / 3]);
    return light;
}
/// Inverse of ToDisplayed.
inline bspGridPointSH_t ToStored(ShFloats light, bool radiance) {
    for (std::size_t i = 0; radiance && i < kShFloats; ++i)
        light[i] /= float(kCosineLobe[i / 3]);
    return std::bit_cast<bspGridPointSH_t>(light);
}

/// Factor that dims light to about what a screen shows: a mean over all directions above 1 / kBright becomes that.
inline float ScreenFactor(const ShFloats &light) {
    constexpr float kBright = 2.2f;
    const float mean = float(kShC0) * std::max({light[0], light[1], light[2]});
    return 1 / std::max(1.0f, kBright * mean);
}

/// Squared difference of what is displayed on a surface, mean over all normals and the channels, bytes^2. The basis is
/// orthonormal, so that is the squared distance of the coefficients over 4 pi.
inline float DisplayError(const ShFloats &a, const ShFloats &b) {
    constexpr float kScale = 255 * 255 / (3 * 4 * std::numbers::pi_v<float>);
    const float dimA = ScreenFactor(a), dimB = ScreenFactor(b);
    float sum = 0;
    for (std::size_t i = 0; i < kShFloats; ++i)
        sum += (dimA * a[i] - dimB * b[i]) * (dimA * a[i] - dimB * b[i]);
    return sum * kScale;
}

} // namespace q3
