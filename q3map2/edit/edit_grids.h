// GPL-2.0-or-later. Light grids of a map whose world was scaled or moved.
#pragma once

#include "common/log.h"
#include "libs/math/vec.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"

namespace q3 {

/// Cell of the legacy grid: worldspawn's gridsize, or 64 64 128 where it is missing or no size.
Float3 GridCellOf(const Entity &world);

/// How positions of a map change: times `factors`, then plus `shift`.
struct AxisTransform {
    Vec3d factors{1, 1, 1}, shift;

    float Apply(float value, std::size_t axis) const { return float(double(value) * factors[axis] + shift[axis]); }
    Float3 Apply(const Float3 &p) const { return {Apply(p[0], 0), Apply(p[1], 1), Apply(p[2], 2)}; }
};

/// Takes the grids of `before` over to `bsp`, the transformed map with transformed world bounds and a gridsize that
/// fits. The head of the SH grid says where its points are, so they move exactly. Engines derive the points of the
/// legacy grid from world bounds and gridsize: where that does not give the transformed points, the grid is dropped
/// with a warning. World bounds and gridsize may change by rounding. BSPX lumps: TransformLumps.
void TransformGrids(const Bsp &before, const AxisTransform &transform, Bsp &bsp, Log &log);

} // namespace q3
