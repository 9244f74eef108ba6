// GPL-2.0-or-later. Points of the legacy grid as engines read them: lump 15, and lightgrid.raw.
#pragma once

#include "q3map2/gridformats/grid_tone.h"
#include "q3map2/gridformats/legacy_points.h"

#include <array>
#include <cstddef>
#include <vector>

namespace q3 {

/// The engine that a legacy grid is written for: what it does with the points, which the encoder undoes.
struct LegacyTarget {
    double ambientScale = 1;  ///< its factor of ambient light: r_ambientScale
    double ambientAdded = 0;  ///< what it adds to ambient light after that, bytes of the lump
    int angleSteps = 255;     ///< steps of an angle byte for 360 degrees: 255 or 256
    bool skipsSolid = false;  ///< leaves points out that are black, so those in solids are
    double directedShare = 0; ///< above 0: the only color that it keeps is ambient + directedShare * directed
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
