// GPL-2.0-or-later. -filter: blur of light over luxels.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Box filter over mapped luxels up to `radius` away on both axes, with weight 1/2 at the outermost.
class LuxelFilter {
  public:
    /// Filters `values`, by super luxel, in place. Values of unmapped luxels do not count and become zero.
    void Apply(const RawLightmap &lightmap, int radius, std::vector<Vec3f> &values);

  private:
    std::vector<float> rowWeight_;
    std::vector<Vec3f> rows_;
};

} // namespace q3
