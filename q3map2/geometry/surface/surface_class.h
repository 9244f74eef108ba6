// GPL-2.0-or-later. Plane, lightmap axis and sample size of draw surfaces.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

#include <cstddef>

namespace q3 {

/// The signed unit axis nearest to `normal`. Ties go to z, then to x.
Vec3f DominantAxis(const Vec3f &normal);
/// True for a surface without a lightmap: its shader says so, or its kind is Triangles (models that are not
/// ForcedMeta).
bool IsVertexLit(const DrawSurface &surface);

/// Sets bounds, plane, lightmap axis and sample size. A surface other than a face or patch that has more than
/// BspOptions::maxVertexLitVerts vertices becomes ForcedMeta.
void ClassifySurface(DrawSurface &surface, PlaneTable &planes, const BspContext &context);
/// ClassifySurface for all surfaces from `first` on.
void ClassifySurfaces(Geometry &geometry, std::size_t first, PlaneTable &planes, const BspContext &context);

} // namespace q3
