// GPL-2.0-or-later. Shader replacements of misc_model entities.
#pragma once

#include "q3map2/geometry/models/model_placement.h"
#include "q3map2/map/bsp_context.h"

#include <string_view>

namespace q3 {

/// The shader replacements defined by the skin file and the _remap keys of a misc_model.
ShaderRemap ShaderRemapOf(const MapEntity &entity, std::string_view model, const BspContext &context);

} // namespace q3
