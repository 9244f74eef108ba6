// GPL-2.0-or-later. Draw surfaces that show internal polygons of the compiler (-debugportals, -debugclip).
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"

#include <cstddef>

namespace q3 {

/// A translucent convex polygon of at least three points; polygons with consecutive numbers have different colors.
DrawSurface DebugSurface(const Polygon &polygon, const Vec3f &normal, const ShaderInfo &shader, std::size_t number);

} // namespace q3
