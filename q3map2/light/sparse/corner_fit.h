// GPL-2.0-or-later. Stored corners fitted to the light inside the cells.
#pragma once

#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/sparse/corner_weights.h"

namespace q3 {

/// Least-squares values of the stored corners: minimizes the sum over all known points s in the open of
/// w(s) |interpolated(s) - light(s)|^2, plus for each corner a pull towards its own light, by conjugate gradients.
/// Points inside cells that touch solids do not count, so that no light is fitted through a wall. w: FitWeight.
/// Returns them in the order of corners.Stored().
std::vector<ShFloats> FitCorners(const Octree &tree, const LatticePoints &light, CornerWeights &corners,
                                 const SparseLattice &lattice, const BspSpace &space);

} // namespace q3
