// GPL-2.0-or-later. Polygons of map compiling: cut by planes, with the tolerances that keep trees sound.
#pragma once

#include "libs/math/winding.h"

namespace q3 {

/// Points as files and engines keep them; arithmetic on them is in double.
using Polygon = Winding<float>;

inline constexpr double kMaxWorldCoord = 65536; ///< game units; nothing lies beyond

/// Cuts by the plane. Points within epsilon are on it and go to both sides. A polygon without a point behind goes whole
/// to the front, one without a point in front whole to the back, one that is all on the plane: nowhere (both empty).
/// New points get the plane's own coordinate on axes where its normal is exactly 1 or -1, and are rounded to float.
void ClipPolygon(const Polygon &w, const Plane &plane, double epsilon, Polygon &front, Polygon &back);
/// The same, but a polygon on the plane is returned as back.
void ClipPolygonKeepOn(const Polygon &w, const Plane &plane, double epsilon, Polygon &front, Polygon &back);
/// Keeps what is in front. False, and w empty, when nothing is left (a polygon on the plane is nothing).
bool ChopPolygon(Polygon &w, const Plane &plane, double epsilon);
/// The same in double, for the windings of brushes.
bool ChopPolygon(Winding<double> &w, const Plane &plane, double epsilon);

enum class PolygonSide { Front, Back, On, Cross };
/// Where it lies, by points farther than 0.1 from the plane.
PolygonSide SideOf(const Polygon &w, const Plane &plane);
/// Fewer than three edges longer than 0.2.
bool IsTiny(const Polygon &w);
/// A square of the plane that covers the world, half edge 131072, clockwise seen from the front.
Polygon BasePolygon(const Plane &plane);
/// The same in double: cuts of it keep their place on slanted planes.
Winding<double> BaseWinding(const Plane &plane);
/// Reversed order of points.
Polygon Reversed(const Polygon &w);
/// Plane through the first three points that are not in a line, its front where the polygon is clockwise. Zero normal:
/// there are none.
Plane PlaneOf(const Polygon &w);

} // namespace q3
