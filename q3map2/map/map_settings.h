// GPL-2.0-or-later. Settings of the surfaces of an entity, from its keys.
#pragma once

#include "q3map2/map/bsp_context.h"
#include "q3map2/map/map.h"

namespace q3 {

/// Settings from the entity's keys. Ambient light and cel shader default to the values of the world.
SurfaceSettings SettingsOf(const MapEntity &entity, const Map &map, const BspContext &context);

} // namespace q3
