// GPL-2.0-or-later. Places of a map where the camera sees the whole test model, a sphere in front of the eye.
#pragma once

#include "q3map2/bspfile/bsp.h"
#include "tools/measure/sphere_light/sphere_view.h"

#include <functional>
#include <vector>

namespace q3 {

/// Random places, the same for each run: nothing visible lies between the eye and the sphere, both are in the open, a
/// floor is below, and `isLit` holds for the center of the sphere. Headings are multiples of 90 degrees, positions
/// whole numbers. Errors: the map has too few.
std::vector<SpherePlace> FindSpherePlaces(const Bsp &bsp, int count, const std::function<bool(const Vec3f &)> &isLit);

} // namespace q3
