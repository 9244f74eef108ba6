// GPL-2.0-or-later. Where in a leaf light is sampled.
#pragma once

#include "q3map2/light/cubes/leaf_polytope.h"
#include "q3map2/light/scene/light_space.h"

#include <array>
#include <cstdint>
#include <vector>

namespace q3 {

/// Where a sample is taken.
struct CubePlace {
    std::array<std::uint8_t, 3> stored{}; ///< position, each 0..255 of the bounds of the leaf
    Vec3f position;                       ///< the same, or the center if that is the only place in the leaf
};

/// Samples that a polytope asks for: one for 32 x 32 x 64 units of its box, as far as it fills that; 1 to 128.
int CubeCount(const LeafPolytope &polytope);

/// Up to CubeCount different places in the leaf, at least 1/32 unit inside every plane that bounds it and outside
/// opaque brushes: of a low-discrepancy pattern that the number of the leaf determines. If there are none, the center,
/// if that is in the open; else none.
std::vector<CubePlace> FindCubePlaces(const BspSpace &space, const LeafPolytopes &polytopes, std::size_t leaf);

} // namespace q3
