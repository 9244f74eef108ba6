// GPL-2.0-or-later. Maps moved as a whole.
#pragma once

#include "common/log.h"
#include "libs/math/vec.h"
#include "q3map2/bspfile/bspfile.h"

#include <string_view>

namespace q3 {

/// Adds the vector to all positions. The model of a brush entity with an `origin` is relative to that and stays, with
/// planes and vertices of its own where it shared them. Lightmaps and visibility stay. `name` is for messages. Errors:
/// a distance over 2^24.
void ShiftMap(Bsp &bsp, const Vec3d &shift, std::string_view name, Log &log);

} // namespace q3
