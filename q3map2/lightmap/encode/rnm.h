// GPL-2.0-or-later. Radiosity normal mapping: light on three basis normals.
// McTaggart, Half-Life 2 / Valve Source Shading, 2004.
#pragma once

#include "libs/math/rnm_basis.h"

#include <array>

namespace q3 {

/// Lit values of the three vectors of kRnmBasis as normals, RGB, unit scale.
struct RnmLight {
    std::array<Vec3f, 3> map{};
    bool operator==(const RnmLight &) const = default;
};

/// Scales the three maps, per channel, so that their mean is the lit value of the flat surface, as shaders expect
/// that square and normalize the weights. A channel without light in all three maps gets `flat` in each. Negative and
/// NaN values count as 0.
RnmLight RescaleToFlat(const RnmLight &raw, const Vec3f &flat);

/// For storage up to 1: the excess over 1 in one map moves in equal halves to the other two, or to one if the other is
/// full. Keeps the mean of each channel up to 1; brighter channels are 1 in all maps.
RnmLight OverflowToOthers(const RnmLight &light);

} // namespace q3
