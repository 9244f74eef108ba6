// GPL-2.0-or-later. Moves brushes and patches relative to the origin of their entity.
#pragma once

#include "q3map2/map/bsp_context.h"
#include "q3map2/map/map.h"

namespace q3 {

/// Moves all brushes and patches of the entity; sides get the numbers of their moved planes.
void MoveEntity(MapEntity &entity, const Vec3f &by, PlaneTable &planes);
/// Joins a func_group with the world: undoes the translation by an origin brush and applies the key origin.
void JoinWorld(MapEntity &group, MapEntity &world, PlaneTable &planes, const BspContext &context);

} // namespace q3
