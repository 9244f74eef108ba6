// GPL-2.0-or-later. Patches that are drawn as triangles.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

#include <cstddef>

namespace q3 {

/// Appends a ForcedMeta surface with the tessellated mesh for each patch (from `first` on) that -patchmeta, its entity
/// or its shader wants as triangles, provided that it will go through the meta step. The patch itself stays for
/// collision (collisionOnly) if its shader is solid, else it becomes empty. To be called before MakeMetaSurfaces.
void MakePatchMeshes(const MapEntity &entity, Geometry &geometry, std::size_t first, const BspContext &context);

} // namespace q3
