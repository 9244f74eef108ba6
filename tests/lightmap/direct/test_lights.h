// GPL-2.0-or-later. Lights for tests of luxels.
#pragma once

#include "q3map2/light/sources/light_sources.h"

namespace q3::test {

inline Light PointLight(const Vec3f &at, float photons) {
    Light light;
    light.origin = at;
    light.photons = photons;
    return light;
}

/// A rectangle that shines along an axis.
inline Light AreaLight(const Vec3f &center, float width, float depth, const Vec3f &normal, float radiosity) {
    Light light;
    light.type = LightType::Area;
    light.normal = normal;
    const Vec3f across = normal.x == 0 ? Vec3f{1, 0, 0} : Vec3f{0, 1, 0};
    const Vec3f x = across * (width / 2), y = Cross(normal, across) * (depth / 2);
    light.polygon = {center - x + y, center + x + y, center + x - y, center - x - y};
    light.radiosity = radiosity;
    light.photons = radiosity / 3 * width * depth;
    light.origin = center + light.normal;
    light.dist = Dot(light.origin, light.normal);
    light.SetShape();
    return light;
}

} // namespace q3::test
