// GPL-2.0-or-later. Draw surfaces of brush sides.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"
#include "q3map2/map/side_parts.h"

namespace q3 {

/// Appends a face with polygon `w` for a side of a brush of `entity`. Returns its index in Geometry::surfaces.
int MakeFaceSurface(const MapEntity &entity, int brush, int side, const Polygon &w, Geometry &geometry,
                    const PlaneTable &planes, const BspContext &context);
/// Appends a face for each visible side of the entity's brushes, or for each of its parts; front and back face for
/// sides of fog brushes.
void MakeFaceSurfaces(MapEntity &entity, Geometry &geometry, const PlaneTable &planes, const BspContext &context,
                      const SideParts &parts = {});

} // namespace q3
