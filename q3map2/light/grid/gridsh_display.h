// GPL-2.0-or-later. Light that a game displays from SH coefficients.
#pragma once

#include "libs/math/vec.h"
#include "libs/shgrid/shgrid.h"
#include "q3map2/bspfile/bspfile.h"

#include <algorithm>
#include <array>

namespace q3 {

/// Light on surfaces that face the 26 faces, edges and corners of a cube, red green blue each: 0 to 255, not rounded.
using DisplayedLight = std::array<float, 26 * 3>;

/// Evaluates the coefficients as engines do. radiance: the coefficients are not yet convolved with the cosine.
inline DisplayedLight DisplayLight(shgrid_coeffs coeffs, bool radiance) {
    if (radiance)
        shgrid_convolve(&coeffs);
    DisplayedLight shown;
    std::size_t at = 0;
    for (int i = 0; i < 27; ++i) {
        const Vec3f n = Normalize(Vec3f{float(i % 3 - 1), float(i / 3 % 3 - 1), float(i / 9 - 1)});
        if (n == Vec3f{})
            continue;
        const float normal[3] = {n.x, n.y, n.z};
        float rgb[3];
        shgrid_evaluate(&coeffs, normal, rgb);
        for (const float light : rgb)
            shown[at++] = 255 * std::min(1.0f, light);
    }
    return shown;
}

inline DisplayedLight DisplayLight(const bspGridPointSH_t &point, bool radiance) {
    shgrid_coeffs coeffs;
    for (std::size_t k = 0; k < 9; ++k)
        for (std::size_t channel = 0; channel < 3; ++channel)
            coeffs.c[k][channel] = point.coeffs[k][channel];
    return DisplayLight(coeffs, radiance);
}

} // namespace q3
