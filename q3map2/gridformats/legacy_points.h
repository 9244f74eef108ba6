// GPL-2.0-or-later. The SH grid sampled at the points of the legacy grid.
#pragma once

#include "q3map2/gridformats/grid_source.h"
#include "q3map2/light/scene/light_space.h"

#include <cstdint>
#include <vector>

namespace q3 {

/// Where a point of the legacy grid is, and so which engines need its light.
enum class PointUse : std::uint8_t {
    Open,  ///< in the open: all engines
    Solid, ///< in solid space, but a cell around it reaches into the open: engines that blend such points
    Only,  ///< the same, and a cell around it with open space has no corner in the open: all engines
    Void   ///< no cell around it reaches into the open: black
};

/// Points of the legacy grid, in the order of its lump.
struct LegacyPoints {
    GridLayout layout;
    std::vector<bspGridPointSH_t> light; ///< convolved
    std::vector<PointUse> use;
};

/// The points that engines expect of the legacy grid, from the bounds of the world and the key gridsize. Errors: no
/// grid can be laid out, or one of more points than the light stage allows.
GridLayout LegacyLayout(const Bsp &bsp);

/// Samples the source at each point. Points in solid space near the open that have no light get it from their
/// neighbors, nearer ones counting more; the result depends on the positions only.
LegacyPoints SampleLegacyPoints(const GridSource &source, const BspSpace &space, const GridLayout &layout);

/// By brush: whether its contents in the file are solid and not translucent.
std::vector<bool> SolidBrushes(const Bsp &bsp);

/// By point of a layout: whether it is in solid space.
std::vector<bool> SolidPoints(const BspSpace &space, const GridLayout &layout);

} // namespace q3
