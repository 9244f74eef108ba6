// GPL-2.0-or-later. -filter: blur of light over luxels.
#pragma once

#include "q3map2/lightmap/direct/luxel_surroundings.h"

namespace q3 {

/// Box filter over the cells around a luxel.
class LuxelFilter {
  public:
    /// Sets `blurred`, by cell, to the mean of `values` over cells at most `radius` away on both axes: the share of a
    /// cell in the box counts, so that the outermost count half if `radius` is whole. Empty cells do not count. Where a
    /// cell is blocked, the one opposite of it does not count either, so that linear gradients stay.
    void Apply(const LuxelSurroundings &around, float radius, const std::vector<Vec3f> &values,
               std::vector<Vec3f> &blurred);

  private:
    std::vector<float> rowWeight_;
    std::vector<Vec3f> rows_;
};

} // namespace q3
