// GPL-2.0-or-later. Sky boxes: a room that engines draw enlarged around the map.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"

#include <array>
#include <optional>

namespace q3 {

/// From the space of the _skybox entity to the space that the engine draws around the map.
struct SkyBoxTransform {
    std::array<std::array<double, 4>, 3> rows{}; ///< point' = rows . (point, 1)
    std::array<Vec3d, 3> rotation{};             ///< rows, for normals
};

/// The transform of the last _skybox entity; empty without one.
std::optional<SkyBoxTransform> ReadSkyBox(const Map &map);
/// The copy of a surface in the sky box; `number` is the original's in the .bsp.
DrawSurface SkyBoxCopy(const DrawSurface &surface, int number, const SkyBoxTransform &transform);

} // namespace q3
