// GPL-2.0-or-later. Sky boxes: a small room whose enlarged copy surrounds the map.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"

#include <array>
#include <optional>

namespace q3 {

/// From the room around the _skybox entity to its enlarged copy: the entity maps to the origin of the world.
struct SkyBoxTransform {
    std::array<std::array<double, 4>, 3> rows{}; ///< point' = rows . (point, 1)
    std::array<Vec3d, 3> rotation{};             ///< rows, for normals
};

/// The transform of the last _skybox entity; empty without one.
std::optional<SkyBoxTransform> ReadSkyBox(const Map &map);
/// The enlarged copy of a surface in the sky box. `number`: number of the original surface in the .bsp.
DrawSurface SkyBoxCopy(const DrawSurface &surface, int number, const SkyBoxTransform &transform);

} // namespace q3
