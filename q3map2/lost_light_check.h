// GPL-2.0-or-later. Warns if lighting a map that lost its light entities made it darker.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bspfile.h"

namespace q3 {

/// Compares the legacy light grid of a map before and after it is lit. Compilers usually leave light entities out of
/// the .bsp, so lighting it again without its .map gives less light.
class LostLightCheck {
  public:
    explicit LostLightCheck(const Bsp &bsp);
    /// After lighting: warns if the map has no light entities and its grid less than two thirds of the light before.
    void Report(const Bsp &bsp, Log &log) const;

  private:
    double before_; ///< mean light of the grid before
};

} // namespace q3
