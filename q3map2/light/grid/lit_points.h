// GPL-2.0-or-later. Where the points of the SH grid are lit from.
#pragma once

#include "q3map2/light/grid/gridsh_fill.h"
#include "q3map2/light/sources/light_sources.h"

#include <vector>

namespace q3 {

/// The state of each point of a grid, and the position that it is lit from. Keeps a reference to the layout.
class LitGridPoints {
  public:
    LitGridPoints(const GridInputs &in, const GridLayout &layout, const GridBricks &bricks);
    /// Changes the state of points in the open that lie on the polygon of an area light to OnEmitter.
    void FindOnEmitters(const std::vector<Light> &lights);

    bool IsLit(std::uint32_t index) const { return litFrom_[index] >= 0; }
    /// Appends a receiver for a point for which IsLit holds.
    void AddReceiver(const BrickPoint &point, std::vector<ReceiverBatch> &blocks) const;
    std::vector<PointState> &States() { return states_; }
    /// Points that are lit from another position than their own, in the order of their index.
    const std::vector<DisplacedPoint> &Displaced() const { return displaced_; }

  private:
    const GridLayout &layout_;
    std::vector<PointState> states_;
    std::vector<int> clusters_; ///< by point: of the point itself, see PlaceInOpen
    std::vector<int> litFrom_;  ///< by point: cluster of the position that it is lit from; kSolidCluster: not lit
    std::vector<DisplacedPoint> displaced_;
};

} // namespace q3
