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

/// A light of a brick, and what its contribution is multiplied by.
struct BrickLight {
    const Light *light = nullptr;
    float weight = 1;
};

/// Lights that can reach some point of a brick, in their order.
///
/// Lights whose bound in the brick is under `faint` (byte scale), if there are many, are represented by a few: going
/// through them in order, every time their bounds add up to `faint` one is taken, with the weight that makes up for the
/// others. Lights of one surface follow each other in the list, so that a taken light stands for its neighbours. 0
/// takes every light.
class BrickLights {
  public:
    BrickLights(const std::vector<Light> &lights, const BrickView &brick, std::uint64_t seed, float faint,
                const LightOptions &options, GridStats &work);
    const std::vector<BrickLight> &List() const { return list_; }
    /// Whether there were many faint lights.
    bool Many() const { return many_; }

  private:
    std::vector<BrickLight> list_;
    bool many_ = false;
};

/// Where the count of a place's faint light starts: spread evenly over places.
float StartOfFaint(std::uint32_t index, float faint);

/// Runs `trace(brick, work)` for every brick on all workers, with progress; adds the work up into `stats`.
void RunGridBricks(const GridInputs &in, const GridBricks &bricks, GridStats &stats,
                   const std::function<void(std::int64_t, GridStats &)> &trace);

} // namespace q3
