// GPL-2.0-or-later. Draw surfaces of brush sides: cut by a grid, and triangulated.
#pragma once

#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/map/bsp_options.h"
#include "q3map2/map/map.h"

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

} // namespace q3
