// GPL-2.0-or-later. Directions in rings over a hemisphere.
#include "q3map2/light/batch/hemisphere_rings.h"

#include <cmath>
#include <numbers>

namespace q3 {

std::vector<Vec3f> HemisphereRings(int elevations, int azimuths) {
    std::vector<Vec3f> directions;
    const double step = kConeDegrees / elevations, radiansPerDegree = std::numbers::pi / 180;
    const auto component = [](double c) { return std::abs(c) < 1e-12 ? 0.0f : float(c); };
    for (int e = 0; e < elevations; ++e)
        for (int a = 0; a < azimuths; ++a) {
            const double polarAngle = (e + 0.5) * step * radiansPerDegree,
                         azimuth = a * 2 * std::numbers::pi / azimuths;
            directions.emplace_back(component(std::sin(polarAngle) * std::cos(azimuth)),
                                    component(std::sin(polarAngle) * std::sin(azimuth)), float(std::cos(polarAngle)));
        }
    return directions;
}

} // namespace q3
