// GPL-2.0-or-later. Three points of a plane, as map text has them.
#pragma once

#include "libs/math/winding.h"

#include <array>
#include <span>
#include <string>

namespace q3 {

/// A plane as map text.
struct PlanePoints {
    std::array<std::string, 3> points; ///< "( x y z )"
    Plane plane;                       ///< what a reader makes of them
};

/// "( x y z )" with all digits.
std::string PointText(const Vec3d &p);
/// The plane through three points of map text; a zero normal when they are in one line.
Plane PlaneThrough(const std::array<Vec3d, 3> &points);
/// Points whose plane, stored as float as readers do, is the given one, which must be stored so too: corners of the
/// winding if they will do with few digits, else points 256 game units apart with as many as it takes. `winding` may be
/// empty.
PlanePoints PointsOfPlane(const Plane &plane, std::span<const Vec3d> winding);

} // namespace q3
