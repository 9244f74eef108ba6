// GPL-2.0-or-later. Lights from infinitely far away.
#pragma once

#include "common/log.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/shader/shader.h"

#include <vector>

namespace q3 {

/// The lights of one sun: samples of equal strength spread over its deviance, the first in its exact direction.
std::vector<Light> MakeSuns(const SunDirective &sun, int skyIndex, const LightOptions &options);

/// The directions and colors of one q3map_skyLight: unit vectors toward the sky, photons of each.
std::vector<SunDirective> SkyLightSuns(const SkyLightDirective &sky, const ShaderInfo &shader, ShaderLibrary &library,
                                       Log &log);

} // namespace q3
