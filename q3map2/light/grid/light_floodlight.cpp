// GPL-2.0-or-later. Floodlight: cheap light from wherever the surroundings are open.
#include "q3map2/light/grid/light_grid.h"

#include <cmath>
#include <numbers>

namespace q3 {

namespace {

constexpr int kAzimuths = 16, kElevations = 4;
constexpr double kElevationStep = 22; // degrees; 88 over the elevations
constexpr float kIgnoreNear = 1.5f;   ///< surfaces nearer than this do not count. Game units

} // namespace

float FloodShare(const LightScene &scene, const Vec3f &p, float up, float distance, bool lowQuality,
                 RayCounts &counts) {
    const int azimuths = lowQuality ? kAzimuths / 2 : kAzimuths;
    double sum = 0;
    int cast = 0;
    for (int elevation = 0; elevation < kElevations; ++elevation) {
        RayPacket rays;
        const double e = (elevation + 0.5) * kElevationStep * std::numbers::pi / 180;
        for (int azimuth = 0; azimuth < azimuths; ++azimuth) {
            const double a = azimuth * 2 * std::numbers::pi / azimuths;
            const auto ray = std::size_t(azimuth);
            rays.origin.Set(ray, p);
            rays.direction.Set(ray, {float(std::sin(e) * std::cos(a)) * up, float(std::sin(e) * std::sin(a)),
                                     float(std::cos(e)) * up});
            rays.distance[ray] = distance;
            rays.live[ray] = -1;
        }
        scene.TraceDistance(rays, kIgnoreNear, counts);
        for (std::size_t ray = 0; ray < std::size_t(azimuths); ++ray, ++cast)
            sum += std::min(1.0f, rays.distance[ray] / distance);
    }
    return float(sum / cast);
}

} // namespace q3
