// GPL-2.0-or-later. Blocks of the .srf file.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"

#include <string>
#include <string_view>

namespace q3 {

/// The block with the defaults of all surfaces. `sampleSize` in game units.
std::string DefaultSurfaceBlock(const SurfaceSettings &world, int sampleSize);
/// The block of surface `number` of the .bsp: its shader, and what differs from the defaults.
std::string SurfaceBlock(const DrawSurface &surface, int number, std::string_view shader, const SurfaceSettings &world,
                         int sampleSize);

} // namespace q3
