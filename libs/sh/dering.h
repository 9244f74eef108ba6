// GPL-2.0-or-later. Deringing of L2 spherical harmonics: coefficients without negative lobes.
// Derivation: docs/sh_math.md.
#pragma once

#include "libs/sh/sh.h"

namespace q3 {

/// The least value of an SH sum over all directions, and a unit direction that attains it.
struct ShMinimum {
    Vec3d direction;
    double value = 0;
};

/// Global minimum over the sphere, exact up to rounding. Coefficients must be finite.
ShMinimum MinimumOfSh(const ShVector &c);

/// Removes negative lobes: keeps coefficient 0 and multiplies band l by 1 / (1 + lambda l^2 (l + 1)^2) with the least
/// lambda, to 1e-4 of the factors, for which the sum is nowhere negative (Sloan, Stupid Spherical Harmonics Tricks,
/// 2008). Returns false, and leaves c as it is, if the sum is nowhere negative already. A changed c stays nonnegative
/// when it is rounded to float: its minimum is at least 1e-6 of its mean. If coefficient 0 is below 1e-30, bands 1 and
/// 2 become zero. Coefficients must be finite and below 1e30.
bool RemoveNegativeLobes(ShVector &c);

} // namespace q3
