// GPL-2.0-or-later. Plane, lightmap axis and sample size of draw surfaces.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

#include <cstddef>

namespace q3 {

/// The signed unit axis nearest to `normal`. Ties go to z, then to x.
Vec3f DominantAxis(const Vec3f &normal);
/// True for a surface without a lightmap: its shader says so, or it comes from a model.
bool IsVertexLit(const DrawSurface &surface);

/// Sets bounds, plane, lightmap axis and sample size. A surface with more vertices than a vertex-lit surface may have
/// becomes ForcedMeta.
void ClassifySurface(DrawSurface &surface, PlaneTable &planes, const BspContext &context);
/// ClassifySurface for all surfaces from `first` on.
void ClassifySurfaces(Geometry &geometry, std::size_t first, PlaneTable &planes, const BspContext &context);

} // namespace q3
