// GPL-2.0-or-later. Convex planar polygons.
#pragma once

#include "libs/math/bounds.h"
#include "libs/math/vec.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace q3 {

template <typename T> using Winding = std::vector<Vec3<T>>;

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

} // namespace q3
