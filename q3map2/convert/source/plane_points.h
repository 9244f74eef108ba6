// GPL-2.0-or-later. Three points of a plane, as map text has them.
#pragma once

#include "libs/math/winding.h"

#include <array>
#include <span>
#include <string>

namespace q3 {

/// A plane as map text, and as readers get it back.
struct PlanePoints {
    std::array<std::string, 3> points; ///< "( x y z )"
    Plane plane;                       ///< through the points as printed
};

/// "( x y z )" with as many digits as it takes to read back the same numbers.
std::string PointText(const Vec3d &p);
/// The plane through three points of map text; its normal is zero if they are collinear.
Plane PlaneThrough(const std::array<Vec3d, 3> &points);
/// Points whose plane rounds to the same floats as `plane`, whose own values must be floats: corners of `winding` with
/// up to 6 decimals if they reproduce it, else points 256 game units apart with up to 12. `winding` may be empty.
PlanePoints PointsOfPlane(const Plane &plane, std::span<const Vec3d> winding);

} // namespace q3
