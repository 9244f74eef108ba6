// GPL-2.0-or-later. Least-squares fit of the stored corners to the light inside the cells.
#pragma once

#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/sparse/corner_weights.h"

namespace q3 {

/// Least-squares values of the stored corners, in the order of corners.Stored(). Minimizes the sum over all points s of
/// `light` in the open, and over `lamps`, of w(s) |interpolated(s) - light(s)|^2, plus for each corner a pull towards
/// its own light, by conjugate gradients. w: FitWeight. Points of cells that touch solids count only where they are
/// stored corners, so that no light is fitted through a wall.
std::vector<ShFloats> FitCorners(const Octree &tree, const LatticePoints &light, CornerWeights &corners,
                                 const SparseLattice &lattice, const BspSpace &space,
                                 std::span<const LampSample> lamps = {});

} // namespace q3
