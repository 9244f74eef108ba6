// GPL-2.0-or-later. The legacy light grid.
#pragma once

#include "q3map2/bspfile/grid_table.h"
#include "q3map2/light/grid/grid_bricks.h"

#include <cstdint>
#include <vector>

namespace q3 {

/// Most points of a legacy grid: limit of NetRadiant's q3map2.
inline constexpr std::int64_t kMaxLegacyPoints = kMaxGridPoints;

/// Cell size of the legacy grid: worldspawn gridsize or 64 64 128, at least 8, enlarged until there are at most
/// kMaxLegacyPoints. Writes a changed size back to `world`.
GridLayout SetupGrid(const Bsp &bsp, Entity &world, Log &log);

/// Where a point of the legacy grid is lit from.
struct LegacyPlace {
    Vec3f position, rayOrigin;   ///< for falloff and angles; where its rays start, clear of solids
    int cluster = kSolidCluster; ///< kSolidCluster: it is not lit
};
/// Finds an open position up to half a cell from a point, the nearest first.
LegacyPlace PlaceLegacyPoint(const BspSpace &space, const GridLayout &layout, const Vec3f &point);

/// The unit direction towards the light of a point: the middle of those that are stored as its bytes.
Vec3f DirectionTowardsLight(const bspGridPoint_t &point);

/// The legacy light grid.
std::vector<bspGridPoint_t> TraceGrid(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
                                      GridStats &stats);

} // namespace q3
