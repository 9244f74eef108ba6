// GPL-2.0-or-later. SH grid points in and beside solids: where they are lit from, and how they are filled.
#pragma once

#include "q3map2/light/grid/grid_bricks.h"
#include "q3map2/light/grid/light_grid.h"
#include "q3map2/light/grid/probe_integrator.h"
#include "q3map2/light/sources/light_sources.h"

#include <array>
#include <cstdint>
#include <vector>

namespace q3 {

/// Points keep this clear of solids when they are lit. Game units.
inline constexpr float kClearance = 0.125f;

enum class PointState : std::uint8_t {
    Exterior,  ///< in a solid, no open space in the cells around it: stays zero
    Open,      ///< lit where it is
    OnEmitter, ///< lit where it is, in the plane of a surface light, which gives nothing there; then fitted
    Beside,    ///< in the plane of a wall or just inside it: lit from a small step beside
    Moved,     ///< in a solid, without lit neighbors: lit from the nearest open position in the cells around it
    Solid,     ///< in a solid, to be filled
    Filled     ///< in a solid, filled from neighbors
};

/// Where a point is lit from.
struct PlacedPoint {
    PointState state = PointState::Exterior;
    Vec3f position;
    int cluster = kSolidCluster;
};

/// State Open if the point can be lit where it is, else Exterior. `cluster` is that of the point, also where it is in
/// the open but too near to a solid; kSolidCluster in a solid.
PlacedPoint PlaceInOpen(const BspSpace &space, const Vec3f &p);

/// State Beside and the position if there is open space a small step from p, else Exterior.
PlacedPoint PlaceBeside(const BspSpace &space, const Vec3f &p);

/// Chooses the state and the lit position of a point for which PlaceInOpen did not return Open. `clusters`: the
/// clusters that PlaceInOpen returned, by grid point.
PlacedPoint PlaceGridPoint(const BspSpace &space, const GridLayout &layout, const std::vector<int> &clusters,
                           const BrickPoint &point);

/// A point that is lit from a position other than its own.
struct DisplacedPoint {
    std::uint32_t index = 0;
    Vec3f position;
};

/// Lit neighbors of points in or beside solids, grouped by mutual visibility.
struct VisibilityGroups {
    /// Lit points around a point: 26 neighbors, and the point itself.
    static constexpr std::size_t kMaxNeighbors = 27;
    struct PointGroups {
        std::uint32_t index = 0, groupCount = 0; ///< the point; number of its groups
        /// Group of the point itself if it is lit, then of each lit neighbor.
        std::array<std::uint8_t, kMaxNeighbors> groups{};
    };
    std::vector<bool> isSplit;       ///< by point: it has more than one group
    std::vector<PointGroups> points; ///< the split ones, by index
};

/// Finds the groups around each point in or beside a solid. `displaced` is sorted by index.
VisibilityGroups FindVisibilityGroups(const GridInputs &in, const GridLayout &layout,
                                      const std::vector<DisplacedPoint> &displaced,
                                      const std::vector<PointState> &states);

/// Gives a value to every point in a solid that has lit neighbors, so that interpolation beside walls is right. A
/// group of neighbors is one side of a wall: the darker a group, the more it counts, so that a wall thinner than a cell
/// lets no light through. Points beside a wall that have several groups are filled too. `displaced` is sorted by index.
/// Changes Solid to Filled or Exterior in `states`.
void FillGridSH(const GridInputs &in, const GridLayout &layout, const std::vector<DisplacedPoint> &displaced,
                const VisibilityGroups &groups, std::vector<PointState> &states, LightGridSH &grid);

/// A lit point that gives its light to a point that FillGridSH fills.
struct FillSource {
    std::uint32_t index = 0; ///< of the lit point
    Vec3f position;          ///< that it is lit from
    int group = 0;           ///< visibility group around the filled point
    double weight = 0;       ///< in the value; the weights of all sources add up to 1
};
/// The sources of a point by FillGridSH; none if it is not filled. states and grid: before it.
std::vector<FillSource> FillSources(const GridLayout &layout, const std::vector<DisplacedPoint> &displaced,
                                    const VisibilityGroups &groups, const std::vector<PointState> &states,
                                    const LightGridSH &grid, std::uint32_t index);

/// The state of each point of a grid, and the position that it is lit from. Keeps a reference to the layout.
class LitGridPoints {
  public:
    LitGridPoints(const GridInputs &in, const GridLayout &layout, const GridBricks &bricks);
    /// Changes the state of points in the open that lie on the polygon of an area light to OnEmitter.
    void FindOnEmitters(const std::vector<Light> &lights);

    bool IsLit(std::uint32_t index) const { return litClusters_[index] >= 0; }
    /// Appends a receiver for a point for which IsLit holds.
    void AddReceiver(const BrickPoint &point, std::vector<ReceiverBatch> &blocks) const;
    std::vector<PointState> &States() { return states_; }
    const std::vector<PointState> &States() const { return states_; }
    /// Points that are lit from another position than their own, in the order of their index.
    const std::vector<DisplacedPoint> &Displaced() const { return displaced_; }

  private:
    const GridLayout &layout_;
    std::vector<PointState> states_;
    std::vector<int> clusters_;    ///< by point: of the point itself, see PlaceInOpen
    std::vector<int> litClusters_; ///< by point: of the position that it is lit from; kSolidCluster: not lit
    std::vector<DisplacedPoint> displaced_;
};

} // namespace q3
