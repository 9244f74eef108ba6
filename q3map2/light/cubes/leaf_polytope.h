// GPL-2.0-or-later. The space of a leaf as a convex polytope.
#pragma once

#include "libs/math/bounds.h"
#include "libs/math/winding.h"
#include "q3map2/bspfile/bsp.h"

#include <vector>

namespace q3 {

/// A convex polytope. Empty if volume is 0.
struct LeafPolytope {
    std::vector<Plane> planes; ///< unit normals to the inside
    Boundsd bounds;            ///< of the corners
    Vec3d center;              ///< center of mass
    double volume = 0;         ///< cubic game units

    /// Whether p is at least `margin` inside every plane.
    bool Contains(const Vec3d &p, double margin) const;
};

/// Finds the polytopes of leafs: their bounds cut by the planes of the nodes above. Const after construction; keeps a
/// reference to a validated Bsp.
class LeafPolytopes {
  public:
    explicit LeafPolytopes(const Bsp &bsp);
    LeafPolytope Of(std::size_t leaf) const;

  private:
    /// The node above a node or leaf, and which of its children that is.
    struct Parent {
        int node = -1, child = 0;
    };

    const Bsp &bsp_;
    std::vector<Parent> ofNodes_, ofLeafs_;
};

} // namespace q3
