// GPL-2.0-or-later. Whether a map without its light entities got darker.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bspfile.h"

#include <cstdint>

namespace q3 {

/// Looks at the legacy light grid of a map before it is lit again. A .bsp from elsewhere seldom has its light entities,
/// so its light may come out darker than it was.
class LostLightCheck {
  public:
    explicit LostLightCheck(const Bsp &bsp);
    /// After lighting: a warning if the map had no light entities and its grid has less than two thirds of its light.
    void Report(const Bsp &bsp, Log &log) const;

  private:
    std::uint64_t before_; ///< sum of all bytes of light in the grid
};

} // namespace q3
