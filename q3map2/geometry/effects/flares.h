// GPL-2.0-or-later. Flares of lights and shaders (-flares).
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

#include <cstddef>

namespace q3 {

/// Appends the flares of light entities.
void MakeFlares(const Map &map, Geometry &geometry, const BspContext &context);
/// Appends the flare of the surface's shader. `origin`: origin of the entity, to which the surface is relative.
void MakeShaderFlare(std::size_t surface, const Vec3f &origin, Geometry &geometry, const BspContext &context);

} // namespace q3
