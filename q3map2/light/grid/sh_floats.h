// GPL-2.0-or-later. Arithmetic of the SH coefficients of a grid point.
#pragma once

#include "libs/sh/sh.h"
#include "q3map2/bspfile/bsp_records.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace q3 {

/// Floats per point: nine coefficients for each of three channels.
inline constexpr std::size_t kShFloats = 27;
static_assert(sizeof(bspGridPointSH_t) == kShFloats * sizeof(float));
/// Coefficients of a point: coefficient k of a channel is at 3 k + channel. 1 = byte 255.
using ShFloats = std::array<float, kShFloats>;

/// Mean over all directions, of the brightest channel. 1 = byte 255.
inline float MeanLight(const ShFloats &light) {
    return float(kShC0) * std::max({light[0], light[1], light[2]});
}

/// sum += factor * value.
inline void AddScaled(float factor, const ShFloats &value, ShFloats &sum) {
    for (std::size_t i = 0; i < kShFloats; ++i)
        sum[i] += factor * value[i];
}
inline void AddScaled(float factor, const bspGridPointSH_t &value, bspGridPointSH_t &sum) {
    for (std::size_t k = 0; k < value.coeffs.size(); ++k)
        for (std::size_t channel = 0; channel < 3; ++channel)
            sum.coeffs[k][channel] += factor * value.coeffs[k][channel];
}

} // namespace q3
