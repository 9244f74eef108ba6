// GPL-2.0-or-later. Real L2 spherical harmonics: basis, cosine convolution, projection of lights.
#pragma once

#include "libs/math/vec.h"

#include <array>
#include <numbers>

namespace q3 {

/// Nine numbers, one per basis function, index l * l + l + m.
using ShVector = std::array<double, 9>;

inline constexpr double kShC0 = 0.28209479177387814; // 1 / (2 sqrt(pi))
inline constexpr double kShC1 = 0.48860251190291992; // sqrt(3) / (2 sqrt(pi))
inline constexpr double kShC2 = 1.09254843059207907; // sqrt(15) / (2 sqrt(pi))
inline constexpr double kShC3 = 0.31539156525252001; // sqrt(5) / (4 sqrt(pi))
inline constexpr double kShC4 = 0.54627421529603953; // sqrt(15) / (4 sqrt(pi))

/// Factors of convolution with the clamped cosine, per basis function.
/// Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment Maps, 2001.
inline constexpr ShVector kCosineLobe = {std::numbers::pi,         2 * std::numbers::pi / 3, 2 * std::numbers::pi / 3,
                                         2 * std::numbers::pi / 3, std::numbers::pi / 4,     std::numbers::pi / 4,
                                         std::numbers::pi / 4,     std::numbers::pi / 4,     std::numbers::pi / 4};

/// Basis functions as linear forms in the monomials 1, x, y, z, xy ... of a unit direction. With the integrals of the
/// monomials over a region of directions (moments) in their place, the result is the projection of the region.
template <typename T>
constexpr std::array<T, 9> ShFromMoments(T one, const Vec3<T> &d, T xy, T yz, T zz, T xz, T xxMinusYy) {
    return {T(kShC0) * one,
            T(kShC1) * d.y,
            T(kShC1) * d.z,
            T(kShC1) * d.x,
            T(kShC2) * xy,
            T(kShC2) * yz,
            T(kShC3) * (3 * zz - one),
            T(kShC2) * xz,
            T(kShC4) * xxMinusYy};
}

/// Y[k](d) for a unit direction.
template <typename T> constexpr std::array<T, 9> ShBasis(const Vec3<T> &d) {
    return ShFromMoments<T>(1, d, d.x * d.y, d.y * d.z, d.z * d.z, d.x * d.z, d.x * d.x - d.y * d.y);
}

} // namespace q3
