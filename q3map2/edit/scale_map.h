// GPL-2.0-or-later. Maps made larger or smaller.
#pragma once

#include "q3map2/bspfile/bspfile.h"
#include "q3map2/edit/edit_options.h"

namespace q3 {

/// Scales geometry, positions of entities, cells of light grids. Lightmaps, visibility and values of the grids stay.
/// `name` is for messages. Errors: a factor that is not above 0.
void ScaleMap(Bsp &bsp, const ScaleOptions &options, std::string_view name, Log &log);

} // namespace q3
