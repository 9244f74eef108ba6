// GPL-2.0-or-later. The space of a leaf as a convex polytope.
#pragma once

#include "libs/math/bounds.h"
#include "libs/math/winding.h"
#include "q3map2/bspfile/bsp.h"

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
    LeafPolytope Of(std::size_t leaf) const;

  private:
    /// The parent of a node or leaf, and which of its children (0 or 1) that node or leaf is.
    struct Parent {
        int node = -1, child = 0;
    };

    const Bsp &bsp_;
    std::vector<Parent> nodeParents_, leafParents_;
};

} // namespace q3
