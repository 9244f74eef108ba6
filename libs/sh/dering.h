// GPL-2.0-or-later. L2 spherical harmonics without negative lobes.
#pragma once

#include "libs/sh/sh.h"

#include <array>

namespace q3 {

/// The least value of a sum over the basis, and a unit direction that has it.
struct ShMinimum {
    Vec3d direction;
    double value = 0;
};

/// Global minimum over all directions, exact up to rounding. Coefficients must be finite.
ShMinimum MinimumOfSh(const ShVector &c);

/// Most that a sum over the basis can change when bands 1 and 2 change by a vector of length 1: sqrt(8 / (4 pi)).
inline constexpr double kShBandReach = 0.79788456080286536;

/// Removes negative lobes: coefficient 0 stays, bands 1 and 2 become the nearest values (in the Euclidean norm) whose
/// sum over the basis is nowhere negative. Leaves c alone and returns false if it is nowhere negative as it is. A
/// changed c stays positive when it is rounded to float: its minimum is 1e-6 of its mean. If coefficient 0 is below
/// 1e-30, bands 1 and 2 become zero. Coefficients must be finite and less than 1e30.
bool RemoveNegativeLobes(ShVector &c);

/// The same for the channels of one point; which of them were changed. Faster, since those of white light are alike.
std::array<bool, 3> RemoveNegativeLobes(std::array<ShVector, 3> &channels);

} // namespace q3
