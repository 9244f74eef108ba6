// GPL-2.0-or-later. Text of edited maps.
#pragma once

#include "libs/math/vec.h"

#include <cstdint>
#include <string>

namespace q3 {

/// Six decimals, without zeros at the end.
std::string NumberText(double number);
std::string VectorText(const Vec3d &v);
/// A bound of a node or leaf, at most 2^30 from 0.
std::int32_t WholeBound(double bound);

} // namespace q3
