// GPL-2.0-or-later. Points of the legacy grid as engines read them, sampled from the SH grid: lump 15, and
// lightgrid.raw.
#pragma once

#include "q3map2/gridformats/grid_source.h"
#include "q3map2/light/scene/light_space.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace q3 {

/// Where a point of the legacy grid is, and so which engines need its light.
enum class PointUse : std::uint8_t {
    Open,       ///< in the open: all engines
    Solid,      ///< in solid space, but a cell around it reaches into the open: engines that blend such points
    SoleSource, ///< the same, and a cell around it with open space has no corner in the open: all engines
    Void        ///< no cell around it reaches into the open: black
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

/// The engine that a legacy grid is written for: what it does with the points, which the encoder undoes.
struct LegacyTarget {
    double ambientScale = 1;   ///< its factor of ambient light: r_ambientScale
    double ambientAdded = 0;   ///< what it adds to ambient light after that, bytes of the lump
    int angleSteps = 255;      ///< steps of an angle byte for 360 degrees: 255 or 256
    bool skipsSolid = false;   ///< leaves points out that are black, so those in solids are
    double directedWeight = 0; ///< above 0: the only color that it keeps is ambient + directedWeight * directed
};

/// Lump 15. `ambientFactor` multiplies ambient light (-gridambientscale). Points outside the void are never black.
std::vector<bspGridPoint_t> EncodeLegacyGrid(const LegacyPoints &points, const LegacyTarget &target,
                                             const GridTone &tone, double ambientFactor);

/// maps/x/lightgrid.raw: for each point ambient and directed light as six floats, times `scale` where 255 is full
/// light; the direction is that of lump 15. Nothing limits the values.
std::vector<std::byte> EncodeRawGrid(const LegacyPoints &points, const LegacyTarget &target, const GridTone &tone,
                                     double ambientFactor, double scale);

/// Polar angle from +z and azimuth from +x of a unit direction, rounded to steps of 360 / angleSteps degrees.
std::array<std::uint8_t, 2> EncodeDirection(const Vec3d &direction, int angleSteps);

} // namespace q3
