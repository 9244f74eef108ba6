// GPL-2.0-or-later. Lights from infinitely far away.
#pragma once

#include "q3map2/light/sources/light_sources.h"

#include <vector>

namespace q3 {

/// The lights of one sun: samples of equal strength spread over its deviance, the first in its exact direction.
std::vector<Light> MakeSuns(const SunDirective &sun, int skyIndex, const LightOptions &options);

} // namespace q3
