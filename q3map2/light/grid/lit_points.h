// GPL-2.0-or-later. Where the points of the SH grid are lit from.
#pragma once

#include "q3map2/light/grid/gridsh_fill.h"
#include "q3map2/light/sources/light_sources.h"

#include <vector>

namespace q3 {

/// Where the points of a grid are lit from, and the state of each. Keeps a reference to the layout.
class LitPoints {
  public:
    LitPoints(const GridInputs &in, const GridLayout &layout, const GridBricks &bricks);
    /// Sets the state of points in the open that are in the plane of an area light.
    void FindOnEmitters(const std::vector<Light> &lights);

    bool IsLit(std::uint32_t index) const { return litFrom_[index] >= 0; }
    /// Adds a receiver for a point that is lit.
    void AddReceiver(const BrickPoint &point, std::vector<ReceiverBatch> &blocks) const;
    std::vector<PointState> &States() { return states_; }
    /// Lit points that are lit from elsewhere, by index.
    const std::vector<DisplacedPoint> &Displaced() const { return displaced_; }

  private:
    const GridLayout &layout_;
    std::vector<PointState> states_;
    std::vector<int> clusters_; ///< by point: of the point itself, see PlaceInOpen
    std::vector<int> litFrom_;  ///< by point: cluster that it is lit from; kSolidCluster: not lit
    std::vector<DisplacedPoint> displaced_;
};

} // namespace q3
