// GPL-2.0-or-later. The SH grid sampled at the points of the legacy grid.
#pragma once

#include "q3map2/gridformats/grid_source.h"
#include "q3map2/light/scene/light_space.h"

#include <cstdint>
#include <vector>

namespace q3 {

/// What a point of the legacy grid is for.
enum class PointUse : std::uint8_t {
    Open,  ///< has the light at its position
    Solid, ///< in solid space; cells around it reach into the open, and it has light for engines that blend it
    Only,  ///< the same, and corner of a cell with open space but no corner in the open: all engines need it
    Void   ///< no cell around it reaches into the open: black
};

/// Points of the legacy grid, in the order of its lump.
struct LegacyPoints {
    GridLayout layout;
    std::vector<bspGridPointSH_t> light; ///< convolved
    std::vector<PointUse> use;
};

/// Where engines expect the legacy grid of the map: from the bounds of the world and the key gridsize. Errors: no grid
/// can be laid out, or one of more points than the light stage allows.
GridLayout LegacyLayout(const Bsp &bsp);

/// Samples the source at each point. Points in solid space near the open that have no light get it from their
/// neighbors, nearer ones counting more; the result depends on the positions only.
LegacyPoints SampleLegacyPoints(const GridSource &source, const BspSpace &space, const GridLayout &layout);

/// For each brush whether it is solid throughout by the contents of the file.
std::vector<bool> SolidBrushes(const Bsp &bsp);

/// For each point of a layout whether it is in solid space.
std::vector<bool> SolidPoints(const BspSpace &space, const GridLayout &layout);

} // namespace q3
