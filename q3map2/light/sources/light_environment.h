// GPL-2.0-or-later. The lights of a light_environment.
#pragma once

#include "q3map2/light/options/light_options.h"
#include "q3map2/light/sources/light_sources.h"

#include <vector>

namespace q3 {

/// The sun and the sky light of a map. Light in byte values; colors with largest component 1.
struct Environment {
    Vec3f direction;      ///< where the sun shines; unit
    Vec3f color{1, 1, 1}; ///< of the sun
    float photons = 0;    ///< of the sun: light on a surface that faces it
    float spread = 0;     ///< angle that the disc of the sun spans. Degrees
    int samples = 1;      ///< directions over the disc, if it has a spread
    Vec3f ambientColor{1, 1, 1};
    float ambient = 0; ///< light of the whole sky on a floor
};

/// Suns through any sky, for the sun and for the sky light. `common`: the fields that all of them share.
std::vector<Light> EnvironmentLights(const Environment &environment, const Light &common, const LightOptions &options);

} // namespace q3
