// GPL-2.0-or-later. What solids are on the straight way between two points.
#pragma once

#include "q3map2/light/scene/light_space.h"

namespace q3 {

enum class Way {
    Open,        ///< no solid
    LeavesSolid, ///< it starts in a solid, leaves it, and passes no other
    Blocked      ///< it passes a solid, or ends in one
};

/// Less than this of a solid on a way does not count. Game units.
inline constexpr float kWayTouch = 0.125f;

/// What is on the way from a to b: solid leafs, and opaque brushes shrunk by kWayTouch. A way in the plane of a face is
/// outside the solid.
Way WayBetween(const BspSpace &space, const Vec3f &a, const Vec3f &b);

} // namespace q3
