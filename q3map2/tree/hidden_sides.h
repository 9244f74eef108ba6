// GPL-2.0-or-later. Culls brush sides that other brushes cover.
#pragma once

#include "q3map2/map/bsp_context.h"
#include "q3map2/map/map.h"

namespace q3 {

/// Sets `culled` of sides that other brushes of the entity cover.
void CullSides(MapEntity &entity, const PlaneTable &planes, const BspContext &context);

} // namespace q3
