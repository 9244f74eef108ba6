// GPL-2.0-or-later. Which parts of a polygon, and how much of a way, lie in the open.
#pragma once

#include "libs/math/winding.h"
#include "q3map2/light/scene/light_space.h"

#include <vector>

namespace q3 {

/// A convex polygon cut where it enters solid leafs and opaque brushes of the world.
struct PolygonParts {
    std::vector<Winding<float>> open, covered; ///< convex
};

/// Cuts no more than needed: a polygon without covered part stays whole.
PolygonParts PartsOf(const Winding<float> &w, const BspSpace &space);

/// Fraction of the straight way from a to b that lies before the first solid leaf or opaque brush: 1 if it meets none,
/// 0 if a is in one. A way along the face of a solid is open.
float FreeShare(const Vec3f &a, const Vec3f &b, const BspSpace &space);

} // namespace q3
