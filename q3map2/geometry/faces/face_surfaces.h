// GPL-2.0-or-later. Draw surfaces of brush sides and patches: cut by a grid, and triangulated.
#pragma once

#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/map/bsp_options.h"
#include "q3map2/map/map.h"
#include "q3map2/map/map_patch.h"

#include <cstddef>

namespace q3 {

/// Replaces each face (from `first` on) whose shader has tessSize by pieces no larger than that. Throws Error for
/// more pieces than -maxmapdrawsurfs allows.
void SubdivideFaces(MapEntity &entity, Geometry &geometry, std::size_t first, const PlaneTable &planes,
                    const BspContext &context);

/// Appends a face with polygon `w` for a side of a brush of `entity`. Returns its index in Geometry::surfaces.
int MakeFaceSurface(const MapEntity &entity, int brush, int side, const Polygon &w, Geometry &geometry,
                    const PlaneTable &planes, const BspContext &context);
/// Appends a face for each visible side of the entity's brushes, or for each of its parts; front and back face for
/// sides of fog brushes.
void MakeFaceSurfaces(MapEntity &entity, Geometry &geometry, const PlaneTable &planes, const BspContext &context,
                      const SideParts &parts = {});

/// Sets the indexes of a face. Tries, until one has no slivers: with -maxarea the split into the largest triangles,
/// then a strip that zigzags across the polygon, then a fan around a vertex inserted in the middle.
void TriangulateFace(DrawSurface &surface, const BspContext &context);

/// Appends a surface for each patch of the entity. Flat patches get a plane number.
void MakePatchSurfaces(MapEntity &entity, Geometry &geometry, PlaneTable &planes, const BspContext &context);

/// The triangles of a surface that is a patch, by its control points.
PatchMesh TessellatedSurface(const DrawSurface &surface, int subdivisions);

/// Tessellates patches (from `first` on) that have -patchmeta or the key _patchMeta, if -meta or q3map_forceMeta sends
/// them through the meta step: appends the mesh as a ForcedMeta surface. The patch itself stays for collision
/// (collisionOnly) if its shader is solid, else it becomes empty. To be called before MakeMetaSurfaces.
void MakePatchMeshes(const MapEntity &entity, Geometry &geometry, std::size_t first, const BspContext &context);

} // namespace q3
