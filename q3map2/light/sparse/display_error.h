// GPL-2.0-or-later. Difference of two lights as a screen shows them.
#pragma once

#include "libs/sh/sh.h"
#include "q3map2/light/sparse/lattice_points.h"

#include <algorithm>
#include <bit>
#include <numbers>

namespace q3 {

/// Cosine-convolved coefficients of stored ones. radiance: the stored ones are not convolved yet (-shradiance).
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

/// Factor that limits light to about what a screen shows: light whose mean over all directions is above 1 / kBright is
/// scaled down to that mean, at which its brightest side is about white.
inline float ScreenFactor(const ShFloats &light) {
    constexpr float kBright = 2.2f;
    return 1 / std::max(1.0f, kBright * MeanLight(light));
}

/// Mean squared difference of the displayed light of surfaces, over all normals and the three channels, bytes^2. The
/// basis is orthonormal: the integral over the normals is the squared distance of the coefficients.
inline float SquaredDisplayError(const ShFloats &a, const ShFloats &b) {
    constexpr float kScale = 255 * 255 / (3 * 4 * std::numbers::pi_v<float>);
    const float dimA = ScreenFactor(a), dimB = ScreenFactor(b);
    float sum = 0;
    for (std::size_t i = 0; i < kShFloats; ++i)
        sum += (dimA * a[i] - dimB * b[i]) * (dimA * a[i] - dimB * b[i]);
    return sum * kScale;
}

} // namespace q3
