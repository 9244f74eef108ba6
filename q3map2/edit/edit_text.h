// GPL-2.0-or-later. Text of edited maps.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Entities of a map; the first is worldspawn. Errors: text that does not parse, or no entity.
std::vector<Entity> EntitiesOf(const Bsp &bsp, std::string_view name);

/// Six decimals, without zeros at the end.
std::string NumberText(double number);
std::string VectorText(const Vec3d &v);
/// A bound of a node or leaf, at most 2^30 from 0.
std::int32_t WholeBound(double bound);

} // namespace q3
