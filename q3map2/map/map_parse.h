// GPL-2.0-or-later. The reader of map sources: text to entities, and settings of surfaces from their keys.
#pragma once

#include "q3map2/map/bsp_options.h"
#include "q3map2/map/map.h"

#include <string_view>

namespace q3 {

/// Reads map text: entities, brushes with windings and bevels, patches. Applies origin brushes and joins func_groups
/// with the world. Throws Error with file, line, entity and primitive.
Map ReadMap(std::string_view text, std::string_view name, const BspContext &context);

/// Settings from the entity's keys. Ambient light and cel shader default to the values of the world.
SurfaceSettings SettingsOf(const MapEntity &entity, const Map &map, const BspContext &context);

} // namespace q3
