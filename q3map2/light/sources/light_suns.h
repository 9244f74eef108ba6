// GPL-2.0-or-later. Suns, sky light, and the lights of a light_environment.
#pragma once

#include "common/log.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/shader/shader_library.h"

#include <vector>

namespace q3 {

/// The lights of one sun: samples of equal strength spread over its deviance, the first in its exact direction.
std::vector<Light> MakeSuns(const SunDirective &sun, int skyIndex, const LightOptions &options);

/// Appends the lights of a sun that an entity makes: through any sky, with the name, the label and what is lit from
/// `common`.
void AddSunOfEntity(const SunDirective &sun, const Light &common, const LightOptions &options,
                    std::vector<Light> &lights);

/// The directions and colors of one q3map_skyLight: unit vectors toward the sky, photons of each.
std::vector<SunDirective> SkyLightSuns(const SkyLightDirective &sky, const ShaderInfo &shader, ShaderLibrary &library,
                                       Log &log);

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
