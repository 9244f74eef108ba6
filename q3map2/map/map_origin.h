// GPL-2.0-or-later. Brushes and patches of an entity that moves about its origin.
#pragma once

#include "q3map2/map/bsp_context.h"
#include "q3map2/map/map.h"

namespace q3 {

/// Moves all brushes and patches of the entity. Planes are looked up anew.
void MoveEntity(MapEntity &entity, const Vec3f &by, PlaneTable &planes);
/// Joins a func_group with the world: brushes and patches go back to where the map has them.
void JoinWorld(MapEntity &group, MapEntity &world, PlaneTable &planes, const BspContext &context);

} // namespace q3
