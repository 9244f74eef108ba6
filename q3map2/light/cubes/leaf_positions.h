// GPL-2.0-or-later. The space of a leaf as a convex polytope, and positions of ambient cubes in it.
#pragma once

#include "libs/math/vec.h"
#include "libs/math/winding.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/light/scene/light_space.h"

#include <array>
#include <cstdint>
#include <vector>

namespace q3 {

/// A convex polytope. Empty if volume is 0.
struct LeafPolytope {
    std::vector<Plane> planes; ///< with unit normals that point inward
    Boundsd bounds;            ///< of the corners
    Vec3d center;              ///< center of mass
    double volume = 0;         ///< cubic game units

    /// Whether p is at least `margin` inside every plane.
    bool Contains(const Vec3d &p, double margin) const;
};

/// Computes the polytopes of leafs: the box of a leaf cut by the planes of all its ancestor nodes. Const after
/// construction; keeps a reference to `bsp`, which must be validated.
class LeafPolytopes {
  public:
    explicit LeafPolytopes(const Bsp &bsp);
    /// The polytope of a leaf.
    LeafPolytope Of(std::size_t leaf) const;

  private:
    /// The parent of a node or leaf, and which of its children (0 or 1) that node or leaf is.
    struct Parent {
        int node = -1, child = 0;
    };

    const Bsp &bsp_;
    std::vector<Parent> nodeParents_, leafParents_;
};

/// Position of a sample.
struct CubePlace {
    std::array<std::uint8_t, 3> stored{}; ///< by axis: 0..255 across the bounds of the leaf
    Vec3f position;                       ///< `stored` decoded; if no such place is open, the leaf's exact center
};

/// Most places in a leaf; a limit of this program.
inline constexpr std::uint32_t kMaxCubePlaces = 128;
/// Number of samples for a polytope: one for each 32 x 32 x 64 units of its box, times the fraction of the box that it
/// fills; 1 to kMaxCubePlaces, or 0 if it is empty.
int CubeCount(const LeafPolytope &polytope);

/// Up to CubeCount different places in the leaf, at least 1/32 unit inside every plane that bounds it and outside
/// opaque brushes, from a low-discrepancy sequence seeded by the leaf's number. If none is found, the center of the
/// leaf if that is in the open.
std::vector<CubePlace> FindCubePlaces(const BspSpace &space, const LeafPolytopes &polytopes, std::size_t leaf);

} // namespace q3
