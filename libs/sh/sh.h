// GPL-2.0-or-later. Real L2 spherical harmonics: basis, cosine convolution, projection of lights, and deringing.
#pragma once

#include "libs/math/vec.h"

#include <array>
#include <numbers>

namespace q3 {

/// Nine numbers, one per basis function, index l * l + l + m.
using SHVector = std::array<double, 9>;

inline constexpr double kSHC0 = 0.28209479177387814; // 1 / (2 sqrt(pi))
inline constexpr double kSHC1 = 0.48860251190291992; // sqrt(3) / (2 sqrt(pi))
inline constexpr double kSHC2 = 1.09254843059207907; // sqrt(15) / (2 sqrt(pi))
inline constexpr double kSHC3 = 0.31539156525252001; // sqrt(5) / (4 sqrt(pi))
inline constexpr double kSHC4 = 0.54627421529603953; // sqrt(15) / (4 sqrt(pi))

/// Factors of convolution with the clamped cosine, per basis function.
/// Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment Maps, 2001.
inline constexpr SHVector kCosineLobe = {std::numbers::pi,         2 * std::numbers::pi / 3, 2 * std::numbers::pi / 3,
                                         2 * std::numbers::pi / 3, std::numbers::pi / 4,     std::numbers::pi / 4,
                                         std::numbers::pi / 4,     std::numbers::pi / 4,     std::numbers::pi / 4};

/// Factor of coefficient k of radiance where it is stored: 1 if radiance is stored, else that of irradiance.
constexpr double StoredFactor(std::size_t k, bool radiance) {
    return radiance ? 1 : kCosineLobe[k];
}

/// Basis functions as linear forms in the monomials 1, x, y, z, xy ... of a unit direction. With the integrals of the
/// monomials over a region of directions (moments) in their place, the result is the projection of the region.
template <typename T>
constexpr std::array<T, 9> SHFromMoments(T one, const Vec3<T> &d, T xy, T yz, T zz, T xz, T xxMinusYy) {
    return {T(kSHC0) * one,
            T(kSHC1) * d.y,
            T(kSHC1) * d.z,
            T(kSHC1) * d.x,
            T(kSHC2) * xy,
            T(kSHC2) * yz,
            T(kSHC3) * (3 * zz - one),
            T(kSHC2) * xz,
            T(kSHC4) * xxMinusYy};
}

/// Y[k](d) for a unit direction.
template <typename T> constexpr std::array<T, 9> SHBasis(const Vec3<T> &d) {
    return SHFromMoments<T>(1, d, d.x * d.y, d.y * d.z, d.z * d.z, d.x * d.z, d.x * d.x - d.y * d.y);
}

// ---- Deringing: coefficients without negative lobes. Derivation: docs/internals/sh_math.md ----

/// The least value of an SH sum over all directions, and a unit direction that attains it.
struct SHMinimum {
    Vec3d direction;
    double value = 0;
};

/// Global minimum over the sphere, exact up to rounding. Coefficients must be finite.
SHMinimum MinimumOfSH(const SHVector &c);

/// Removes negative lobes: keeps coefficient 0 and multiplies band l by 1 / (1 + lambda l^2 (l + 1)^2) with the least
/// lambda, to 1e-4 of the factors, for which the sum is nowhere negative (Sloan, Stupid Spherical Harmonics Tricks,
/// 2008). Returns false, and leaves c as it is, if the sum is nowhere negative already. A changed c stays nonnegative
/// when it is rounded to float: its minimum is at least 1e-6 of its mean. If coefficient 0 is below 1e-30, bands 1 and
/// 2 become zero. Coefficients must be finite and below 1e30.
bool RemoveNegativeLobes(SHVector &c);

} // namespace q3
