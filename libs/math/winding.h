// GPL-2.0-or-later. Convex planar polygons: areas, hulls, and clipping with the tolerances of map compilers.
#pragma once

#include "libs/math/vec.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace q3 {

/// The corners of a polygon in order.
template <typename T> using Winding = std::vector<Vec3<T>>;

/// The points p with normal . p = dist; its front is where normal . p > dist.
struct Plane {
    Vec3d normal;
    double dist = 0;
    double Distance(const Vec3d &p) const { return Dot(normal, p) - dist; }
};

/// The square of half edge `halfSize` in the plane, centered at the point of the plane nearest to the origin.
inline Winding<double> WindingInPlane(const Plane &plane, double halfSize) {
    const Vec3d &n = plane.normal;
    const double ax = std::abs(n.x), ay = std::abs(n.y), az = std::abs(n.z);
    const Vec3d axis = az >= ax && az >= ay ? Vec3d{1, 0, 0} : Vec3d{0, 0, 1};
    const Vec3d right = Normalize(axis - n * Dot(axis, n)) * halfSize;
    const Vec3d up = Cross(n, right);
    const Vec3d center = n * plane.dist;
    return {center - right + up, center + right + up, center + right - up, center - right - up};
}

/// Splits convex polygons by planes. Keeps its memory from cut to cut.
template <typename T> class WindingCutter {
  public:
    /// Classifies the points of w against the plane Dot(normal, p) = dist. Points within epsilon are on the plane.
    void Classify(const Winding<T> &w, const Vec3<T> &normal, T dist, T epsilon) {
        if (distances_.size() < w.size())
            distances_.resize(w.size());
        T least = 0, most = 0;
        T *distance = distances_.data();
        for (const Vec3<T> &p : w) {
            const T d = *distance++ = Dot(normal, p) - dist;
            least = std::min(least, d), most = std::max(most, d);
        }
        epsilon_ = epsilon, anyFront_ = most > epsilon, anyBack_ = least < -epsilon;
    }
    /// Whether points of the polygon last classified are in front of, or behind, the plane.
    bool AnyFront() const { return anyFront_; }
    bool AnyBack() const { return anyBack_; }
    /// The part on one side of the plane of w, which must be the polygon last classified. Points on the plane are in
    /// both parts. Empty if fewer than three points are left.
    void Front(const Winding<T> &w, Winding<T> &part) const { Part(w, T(1), part); }
    void Back(const Winding<T> &w, Winding<T> &part) const { Part(w, T(-1), part); }

  private:
    void Part(const Winding<T> &w, T side, Winding<T> &part) const {
        part.clear();
        for (std::size_t i = 0; i < w.size(); ++i) {
            const std::size_t next = i + 1 < w.size() ? i + 1 : 0;
            const T da = distances_[i], db = distances_[next];
            if (da * side >= -epsilon_)
                part.push_back(w[i]);
            if ((da > epsilon_ && db < -epsilon_) || (da < -epsilon_ && db > epsilon_))
                part.push_back(w[i] + (w[next] - w[i]) * (da / (da - db)));
        }
        if (part.size() < 3)
            part.clear();
    }

    std::vector<T> distances_;
    T epsilon_ = 0;
    bool anyFront_ = false, anyBack_ = false;
};

/// Splits a convex polygon by the plane where coordinate `axis` is `dist`. Corners have a position `xyz`; those within
/// epsilon of the plane go to both sides, and lerp(a, b, t) makes new ones. `front` and `back` must be empty.
template <typename Corner, typename Lerp>
void CutAcrossAxis(const std::vector<Corner> &corners, std::size_t axis, float dist, float epsilon, const Lerp &lerp,
                   std::vector<Corner> &front, std::vector<Corner> &back) {
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Corner &a = corners[i], &b = corners[(i + 1) % corners.size()];
        const float da = a.xyz[axis] - dist, db = b.xyz[axis] - dist;
        if (da >= -epsilon)
            front.push_back(a);
        if (da <= epsilon)
            back.push_back(a);
        if ((da > epsilon && db < -epsilon) || (da < -epsilon && db > epsilon)) {
            const Corner cut = lerp(a, b, da / (da - db));
            front.push_back(cut), back.push_back(cut);
        }
    }
}

/// Half the sum of cross products; its length is the area. Points: a Winding or an array.
template <typename Points> Vec3d WindingAreaVector(const Points &w) {
    Vec3d sum;
    for (std::size_t i = 2; i < w.size(); ++i)
        sum += Cross(Vec3d(w[i - 1] - w[0]), Vec3d(w[i] - w[0]));
    return sum * 0.5;
}
template <typename Points> double WindingArea(const Points &w) {
    return Length(WindingAreaVector(w));
}
template <typename T> Bounds<T> WindingBounds(const Winding<T> &w) {
    Bounds<T> bounds;
    for (const Vec3<T> &p : w)
        bounds.Add(p);
    return bounds;
}

/// Approximate maximum number of pieces that a polygon is subdivided into.
inline constexpr double kMaxPolygonPieces = 65536;
/// The smallest limit for the sides of the pieces' bounds that keeps their number below about kMaxPolygonPieces: pieces
/// are halved until they are within it, so their area is at least about half its square. Game units.
inline float LeastPieceSize(const Winding<float> &w) {
    const Boundsf box = WindingBounds(w);
    const double length = double(MaxComponent(box.maxs - box.mins));
    return float(std::max(length / kMaxPolygonPieces, std::sqrt(2 * WindingArea(w) / kMaxPolygonPieces)));
}

/// The convex hull of points in a plane, clockwise as seen from the tip of the unit normal, without corners that stick
/// out by less than `tolerance`. Empty when all points are that close to a line. Andrew's monotone chain.
inline Winding<double> ConvexHull(std::vector<Vec3d> points, const Vec3d &normal, double tolerance) {
    constexpr double kNearX = 0.6; // with it, the axis is at least 36 degrees from the normal
    const Vec3d axis = std::abs(normal.x) < kNearX ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d right = Normalize(Cross(axis, normal)), up = Cross(normal, right);
    // Stable, as points that differ only along the normal compare equal.
    std::stable_sort(points.begin(), points.end(), [&](const Vec3d &a, const Vec3d &b) {
        const double ax = Dot(a, right), bx = Dot(b, right);
        return ax != bx ? ax < bx : Dot(a, up) < Dot(b, up);
    });
    Winding<double> hull;
    // Adds p to the hull and drops the corners that it makes superfluous; the first `kept` corners stay.
    const auto add = [&](const Vec3d &p, std::size_t kept) {
        while (hull.size() > kept) {
            const Vec3d &a = hull[hull.size() - 2], &b = hull.back();
            // Where p turns back, b is an extreme point, however near it is to the line through a and p.
            const double least = Dot(p - b, b - a) > 0 ? tolerance * Length(p - a) : 0;
            if (Dot(Cross(p - b, b - a), normal) > least)
                break;
            hull.pop_back();
        }
        hull.push_back(p);
    };
    for (const Vec3d &p : points)
        add(p, 1);
    const std::size_t half = hull.size();
    for (auto p = points.rbegin(); p != points.rend(); ++p)
        add(*p, half);
    if (!hull.empty())
        hull.pop_back();
    if (hull.size() < 3)
        hull.clear();
    return hull;
}

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
/// The side on which a polygon lies, by its points farther than 0.1 game units from the plane.
PolygonSide SideOf(const Polygon &w, const Plane &plane);
/// Whether fewer than three edges are longer than 0.2 game units.
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
