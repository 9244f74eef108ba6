// GPL-2.0-or-later. The reader of map sources.
#pragma once

#include "q3map2/map/bsp_context.h"
#include "q3map2/map/map.h"

#include <string_view>

namespace q3 {

/// Reads map text: entities, brushes with windings and bevels, patches. Applies origin brushes and joins func_groups
/// with the world. Throws Error with file, line, entity and primitive.
Map ReadMap(std::string_view text, std::string_view name, const BspContext &context);

} // namespace q3
