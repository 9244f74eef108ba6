// GPL-2.0-or-later. Clipping of brush and tree windings, with the tolerances of map compilers.
#pragma once

#include "libs/math/winding.h"

namespace q3 {

/// Points in float, as in files and engines; arithmetic on them is in double.
using Polygon = Winding<float>;

inline constexpr double kMaxWorldCoord = 65536; ///< game units; nothing lies beyond

/// Splits by the plane. Points within epsilon are on it and go to both sides. A polygon without a point behind goes to
/// the front as it is, one without a point in front to the back; for one that lies in the plane both are empty.
/// New points get the plane's own coordinate on axes where its normal is exactly 1 or -1, and are rounded to float.
void ClipPolygon(const Polygon &w, const Plane &plane, double epsilon, Polygon &front, Polygon &back);
/// The same, but a polygon on the plane is returned as back.
void ClipPolygonKeepOn(const Polygon &w, const Plane &plane, double epsilon, Polygon &front, Polygon &back);
/// Clips to the front. False, and w empty, when nothing is left; also for a polygon in the plane.
bool ChopPolygon(Polygon &w, const Plane &plane, double epsilon);
/// The same in double, for the windings of brushes.
bool ChopPolygon(Winding<double> &w, const Plane &plane, double epsilon);

enum class PolygonSide { Front, Back, On, Cross };
/// The side on which a polygon lies, by its points farther than 0.1 from the plane.
PolygonSide SideOf(const Polygon &w, const Plane &plane);
/// Whether fewer than three edges are longer than 0.2.
bool IsTiny(const Polygon &w);
/// A square of the plane that covers the world, half edge 131072, clockwise seen from the front.
Polygon BasePolygon(const Plane &plane);
/// The same in double, so that clips of it stay exact on slanted planes.
Winding<double> BaseWinding(const Plane &plane);
/// Reversed order of points.
Polygon Reversed(const Polygon &w);
/// Plane through the first three points that are not collinear; seen from its front the polygon is clockwise. The
/// normal is zero if there are none.
Plane PlaneOf(const Polygon &w);

} // namespace q3
