// GPL-2.0-or-later. Light grids in bricks: neighbouring points share their lights and their rays.
#pragma once

#include "q3map2/light/light_grid.h"

#include <algorithm>
#include <functional>
#include <span>
#include <vector>

namespace q3 {

struct BrickPoint {
    Vec3f position;
    std::uint32_t index = 0; ///< of the grid point
};

/// Cuts a grid into bricks of 8 x 8 x 4 points.
class GridBricks {
  public:
    explicit GridBricks(const GridLayout &layout);
    std::int64_t Count() const { return count_; }
    /// Points of a brick, in blocks of 4 x 2 x 2, so that consecutive points are neighbours.
    std::vector<BrickPoint> Points(std::int64_t brick) const;

  private:
    const GridLayout &layout_;
    std::array<int, 3> bricks_{};
    std::int64_t count_ = 0;
};

/// Where the places of a brick are.
struct BrickView {
    explicit BrickView(std::span<const LightPlace> places);
    Boundsf box;
    std::vector<int> clusters; ///< each once
};

/// Lights that can reach some point of a brick, in their order.
class BrickLights {
  public:
    /// Lights that together give at most `tolerance` (byte scale) to any point of the brick are left out, faintest
    /// first.
    BrickLights(const std::vector<Light> &lights, const BrickView &brick, float tolerance, const LightOptions &options,
                GridStats &work);
    const std::vector<const Light *> &List() const { return list_; }

  private:
    std::vector<const Light *> list_;
};

/// Runs `trace(brick, work)` for every brick on all workers, with progress; adds the work up into `stats`.
void RunGridBricks(const GridInputs &in, const GridBricks &bricks, GridStats &stats,
                   const std::function<void(std::int64_t, GridStats &)> &trace);

} // namespace q3
