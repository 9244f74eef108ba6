// GPL-2.0-or-later. Floodlight: cheap light from wherever the surroundings are open.
#pragma once

#include "q3map2/light/scene/light_scene.h"

#include <span>
#include <vector>

namespace q3 {

/// Directions of the rays of FloodShare in the hemisphere around +z, at four elevations; half as many if lowQuality.
std::vector<Vec3f> FloodDirections(bool lowQuality);
/// Share of the hemisphere around +z or -z (up: +1 or -1) that is open within `distance`, 0 to 1: the mean over rays of
/// min(1, free length / distance).
float FloodShare(const LightScene &scene, const Vec3f &p, float up, float distance, std::span<const Vec3f> directions,
                 RayCounts &counts);

} // namespace q3
