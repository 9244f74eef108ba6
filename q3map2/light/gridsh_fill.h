// GPL-2.0-or-later. SH grid points in solids: where they take their light from.
#pragma once

#include "q3map2/light/grid_bricks.h"
#include "q3map2/light/light_grid.h"

#include <cstdint>
#include <vector>

namespace q3 {

enum class PointState : std::uint8_t {
    Void,   ///< in a solid, no open space in the cells around it: stays zero
    Open,   ///< lit where it is
    OnLamp, ///< lit where it is, in the plane of a surface light, which gives nothing there; then fitted
    Beside, ///< in the plane of a wall or just inside it: lit from a small step beside
    Moved,  ///< in a solid that leaves no lit neighbour: lit from the nearest open place of its cells
    Solid,  ///< in a solid, to be filled
    Filled  ///< in a solid, filled from neighbours
};

struct PlacedPoint {
    PointState state = PointState::Void;
    Vec3f position;
    int cluster = kSolidCluster;
};

/// Cluster of a point that may be lit where it is, else kSolidCluster.
int ClusterOfPoint(const BspRegion &space, const Vec3f &p);

/// Decides where a point is lit from. `space` holds the cells around it, `clusters` ClusterOfPoint of all points.
PlacedPoint PlaceGridPoint(const BspRegion &space, const GridLayout &layout, const std::vector<int> &clusters,
                           const BrickPoint &point);

/// Where a point is lit from, when that is not where it is.
struct Displacement {
    std::uint32_t index = 0;
    Vec3f position;
};

/// By point: whether it is in or beside a solid that divides its lit neighbours into some that do not see each other.
std::vector<bool> DividedPoints(const GridInputs &in, const GridLayout &layout,
                                const std::vector<Displacement> &displaced, const std::vector<PointState> &states,
                                const LightGridSH &grid);

/// Gives every point in a solid that has lit neighbours a value, so that interpolation beside walls is right.
/// Neighbours that do not see each other form sides; a side counts the more the darker it is, so that a wall thinner
/// than a cell lets no light through. A point beside a wall is treated alike when it has neighbours on the other side.
/// `displaced` is sorted by index; `divided` comes from DividedPoints. Changes Solid to Filled or Void in `states`.
void FillGridSH(const GridInputs &in, const GridLayout &layout, const std::vector<Displacement> &displaced,
                const std::vector<bool> &divided, std::vector<PointState> &states, LightGridSH &grid);

} // namespace q3
