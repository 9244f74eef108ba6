// GPL-2.0-or-later. -filter: blur of light over luxels.
#pragma once

#include "q3map2/lightmap/direct/luxel_surroundings.h"

namespace q3 {

/// Box filter over the cells around a luxel.
class LuxelFilter {
  public:
    /// Sets `blurred`, by cell, to the mean of `values`, interpolated linearly between cells, over a box that reaches
    /// `radius` (at least 1) to all sides; so the outermost cells count half if `radius` is whole. The variance of such
    /// a box is radius^2 / 3 + 1 / 6 on each axis. Empty cells do not count. Where a cell is blocked, the one opposite
    /// of it does not count either, so that linear gradients stay.
    void Apply(const LuxelSurroundings &around, float radius, const std::vector<Vec3f> &values,
               std::vector<Vec3f> &blurred);

  private:
    std::vector<float> rowWeight_;
    std::vector<Vec3f> rows_;
};

} // namespace q3
