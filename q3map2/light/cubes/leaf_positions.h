// GPL-2.0-or-later. Positions of ambient cubes in a leaf.
#pragma once

#include "q3map2/light/cubes/leaf_polytope.h"
#include "q3map2/light/scene/light_space.h"

#include <array>
#include <cstdint>
#include <vector>

namespace q3 {

/// Position of a sample.
struct CubePlace {
    std::array<std::uint8_t, 3> stored{}; ///< by axis: 0..255 across the bounds of the leaf
    Vec3f position;                       ///< `stored` decoded; if no such place is open, the leaf's exact center
};

/// Number of samples for a polytope: one for each 32 x 32 x 64 units of its box, times the share of the box that it
/// fills; 1 to 128, or 0 if it is empty.
int CubeCount(const LeafPolytope &polytope);

/// Up to CubeCount different places in the leaf, at least 1/32 unit inside every plane that bounds it and outside
/// opaque brushes, from a low-discrepancy sequence seeded by the leaf's number. If none is found, the center of the
/// leaf if that is in the open.
std::vector<CubePlace> FindCubePlaces(const BspSpace &space, const LeafPolytopes &polytopes, std::size_t leaf);

} // namespace q3
