// GPL-2.0-or-later. Convex planar polygons: areas, hulls, and clipping with the tolerances of map compilers.
#include "libs/math/winding.h"

#include <cstdint>
#include <utility>

namespace q3 {

namespace {

/// Game units: distance up to which a point is on a plane, and length up to which an edge does not count.
constexpr double kOnPlane = 0.1, kTinyEdge = 0.2;
constexpr double kBaseHalfEdge = 2 * kMaxWorldCoord; ///< of BaseWinding: covers the world on slanted planes too

enum PointSide : std::uint8_t { kFront, kBack, kOn };

/// Distance and side of each point of a polygon relative to a plane. Few polygons have more than kInline points.
class PointSides {
  public:
    template <typename T> PointSides(const Winding<T> &w, const Plane &plane, double epsilon) {
        if (w.size() > kInline)
            many_.resize(w.size());
        at_ = many_.empty() ? few_ : many_.data();
        for (std::size_t i = 0; i < w.size(); ++i) {
            const double distance = plane.Distance(Vec3d(w[i]));
            const PointSide side = distance > epsilon ? kFront : distance < -epsilon ? kBack : kOn;
            at_[i] = {distance, side};
            ++counts_[side];
        }
    }
    PointSides(const PointSides &) = delete;
    PointSides &operator=(const PointSides &) = delete;
    double Distance(std::size_t i) const { return at_[i].first; }
    PointSide At(std::size_t i) const { return at_[i].second; }
    bool Any(PointSide side) const { return counts_[side] > 0; }

  private:
    using Entry = std::pair<double, PointSide>;
    static constexpr std::size_t kInline = 32;
    Entry few_[kInline];
    std::vector<Entry> many_;
    Entry *at_ = nullptr;
    int counts_[3] = {};
};

/// Where the edge from a to b, at distances da and db from the plane, goes through it.
template <typename T> Vec3<T> CutPoint(const Vec3<T> &a, const Vec3<T> &b, double da, double db, const Plane &plane) {
    const Vec3d from(a), to(b);
    const double t = da / (da - db);
    Vec3<T> cut;
    for (std::size_t axis = 0; axis < 3; ++axis)
        cut[axis] = T(plane.normal[axis] == 1    ? plane.dist
                      : plane.normal[axis] == -1 ? -plane.dist
                                                 : from[axis] + t * (to[axis] - from[axis]));
    return cut;
}

/// Calls the two functions with the points of the front and the back part, in order.
template <typename T, typename ToFront, typename ToBack>
void WalkCut(const Winding<T> &w, const PointSides &sides, const Plane &plane, ToFront toFront, ToBack toBack) {
    for (std::size_t i = 0; i < w.size(); ++i) {
        const std::size_t next = i + 1 < w.size() ? i + 1 : 0;
        const PointSide here = sides.At(i), there = sides.At(next);
        if (here != kBack)
            toFront(w[i]);
        if (here != kFront)
            toBack(w[i]);
        if (here == kOn || there == kOn || here == there)
            continue;
        const Vec3<T> cut = CutPoint(w[i], w[next], sides.Distance(i), sides.Distance(next), plane);
        toFront(cut), toBack(cut);
    }
}

/// Where ClipPolygon puts a polygon that lies in the plane.
enum class InPlane { Dropped, Back };

void Clip(const Polygon &w, const Plane &plane, double epsilon, InPlane inPlane, Polygon &front, Polygon &back) {
    if (&w == &front || &w == &back)
        return Clip(Polygon(w), plane, epsilon, inPlane, front, back);
    front.clear(), back.clear();
    const PointSides sides(w, plane, epsilon);
    if (!sides.Any(kFront)) {
        if (inPlane == InPlane::Back || sides.Any(kBack))
            back = w;
        return;
    }
    if (!sides.Any(kBack)) {
        front = w;
        return;
    }
    front.reserve(w.size() + 2), back.reserve(w.size() + 2);
    WalkCut(
        w, sides, plane, [&](const Vec3f &p) { front.push_back(p); }, [&](const Vec3f &p) { back.push_back(p); });
}

template <typename T> bool Chop(Winding<T> &w, const Plane &plane, double epsilon) {
    const PointSides sides(w, plane, epsilon);
    if (!sides.Any(kFront)) {
        w.clear();
        return false;
    }
    if (!sides.Any(kBack))
        return true;
    Winding<T> front;
    front.reserve(w.size() + 2);
    WalkCut(
        w, sides, plane, [&](const Vec3<T> &p) { front.push_back(p); }, [](const Vec3<T> &) {});
    w = std::move(front);
    return true;
}

} // namespace

void ClipPolygon(const Polygon &w, const Plane &plane, double epsilon, Polygon &front, Polygon &back) {
    Clip(w, plane, epsilon, InPlane::Dropped, front, back);
}

void ClipPolygonKeepOn(const Polygon &w, const Plane &plane, double epsilon, Polygon &front, Polygon &back) {
    Clip(w, plane, epsilon, InPlane::Back, front, back);
}

bool ChopPolygon(Polygon &w, const Plane &plane, double epsilon) {
    return Chop(w, plane, epsilon);
}

bool ChopPolygon(Winding<double> &w, const Plane &plane, double epsilon) {
    return Chop(w, plane, epsilon);
}

PolygonSide SideOf(const Polygon &w, const Plane &plane) {
    bool front = false, back = false;
    for (const Vec3f &p : w) {
        const double distance = plane.Distance(Vec3d(p));
        front |= distance > kOnPlane, back |= distance < -kOnPlane;
        if (front && back)
            return PolygonSide::Cross;
    }
    return front ? PolygonSide::Front : back ? PolygonSide::Back : PolygonSide::On;
}

bool IsTiny(const Polygon &w) {
    int longEdges = 0;
    for (std::size_t i = 0; i < w.size() && longEdges < 3; ++i)
        longEdges += Length(Vec3d(w[(i + 1) % w.size()]) - Vec3d(w[i])) > kTinyEdge;
    return longEdges < 3;
}

Winding<double> BaseWinding(const Plane &plane) {
    const Vec3d &n = plane.normal;
    std::size_t dominant = 0;
    for (std::size_t axis = 1; axis < 3; ++axis)
        if (std::abs(n[axis]) > std::abs(n[dominant]))
            dominant = axis;
    const Vec3d axis = dominant == 2 ? Vec3d{1, 0, 0} : Vec3d{0, 0, 1};
    const Vec3d up = Normalize(axis - n * Dot(axis, n));
    const Vec3d right = Cross(up, n) * kBaseHalfEdge;
    const Vec3d center = n * plane.dist, top = up * kBaseHalfEdge;
    return {center - right + top, center + right + top, center + right - top, center - right - top};
}

Polygon BasePolygon(const Plane &plane) {
    const Winding<double> base = BaseWinding(plane);
    return {Vec3f(base[0]), Vec3f(base[1]), Vec3f(base[2]), Vec3f(base[3])};
}

Polygon Reversed(const Polygon &w) {
    return {w.rbegin(), w.rend()};
}

Plane PlaneOf(const Polygon &w) {
    constexpr double kInLine = 1e-6; // sine of the angle
    for (std::size_t i = 1; i + 1 < w.size(); ++i) {
        const Vec3d origin(w[0]), a = Vec3d(w[i + 1]) - origin, b = Vec3d(w[i]) - origin;
        const Vec3d cross = Cross(a, b);
        const double length = Length(cross);
        if (length > 0 && length > kInLine * Length(a) * Length(b)) {
            const Vec3d normal = cross / length;
            return {normal, Dot(normal, origin)};
        }
    }
    return {};
}

} // namespace q3
