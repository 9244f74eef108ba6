// GPL-2.0-or-later. Draw surfaces of patches, and patches that are drawn as triangles.
#pragma once

#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/map/bsp_options.h"
#include "q3map2/map/map_patch.h"

#include <cstddef>

namespace q3 {

/// Appends a surface for each patch of the entity. Flat patches get a plane number.
void MakePatchSurfaces(MapEntity &entity, Geometry &geometry, PlaneTable &planes, const BspContext &context);

/// The triangles of a surface that is a patch, by its control points.
PatchMesh TessellatedSurface(const DrawSurface &surface, int subdivisions);

/// Tessellates patches (from `first` on) that have -patchmeta or the key _patchMeta, if -meta or q3map_forceMeta sends
/// them through the meta step: appends the mesh as a ForcedMeta surface. The patch itself stays for collision
/// (collisionOnly) if its shader is solid, else it becomes empty. To be called before MakeMetaSurfaces.
void MakePatchMeshes(const MapEntity &entity, Geometry &geometry, std::size_t first, const BspContext &context);

} // namespace q3
