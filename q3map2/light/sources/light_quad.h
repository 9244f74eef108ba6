// GPL-2.0-or-later. Colors with a brightness, R G B I, as Source writes light.
#pragma once

#include "libs/math/vec.h"

#include <array>
#include <cmath>

namespace q3 {

/// Red, green, blue and brightness, byte scale; colors are gamma-encoded.
using LightQuad = std::array<double, 4>;

/// The linear color of a quad, where byte 255 is 1: (c / 255)^2.2. The light of the quad is this times its brightness.
inline Vec3d LinearColor(const LightQuad &quad) {
    constexpr double kSourceGamma = 2.2;
    Vec3d linear;
    for (std::size_t channel = 0; channel < 3; ++channel)
        linear[channel] = std::pow(quad[channel] / 255, kSourceGamma);
    return linear;
}

} // namespace q3
