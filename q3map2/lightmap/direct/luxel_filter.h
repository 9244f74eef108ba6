// GPL-2.0-or-later. -filter: blur of light over luxels.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Blur of dense rows: the mean over mapped luxels up to `radius` away on both axes, the outermost by half.
class LuxelFilter {
  public:
    /// `values` of super luxels in place; those of luxels that are not mapped do not count, and become zero.
    void Apply(const RawLightmap &lightmap, int radius, std::vector<Vec3f> &values);

  private:
    std::vector<float> rowWeight_;
    std::vector<Vec3f> rows_;
};

} // namespace q3
