// GPL-2.0-or-later. The table of planes that a compile shares, as it goes into the .bsp.
#pragma once

#include "libs/math/winding.h"

#include <array>
#include <span>
#include <vector>

namespace q3 {

/// Planes in pairs: i and i ^ 1 are opposite. One with a component of exactly +-1 has the positive one at the even
/// number. Stored with the precision of float. Look-ups snap: normals near an axis or a coordinate plane go there, and
/// distances along axes to whole numbers.
class PlaneTable {
  public:
    PlaneTable(double normalEpsilon, double distanceEpsilon)
        : normalEpsilon_(normalEpsilon), distanceEpsilon_(distanceEpsilon), chains_(kHashes, -1) {}

    /// Number of the plane, found or appended. `points` lie on it and must stay within the distance epsilon of a match.
    /// -1: the normal is shorter than a half.
    int Find(const Vec3d &normal, double dist, std::span<const Vec3d> points = {});
    /// Float values, held in double.
    const Plane &operator[](int number) const { return planes_[std::size_t(number)]; }
    int Count() const { return int(planes_.size()); }
    /// Whether a plane equals that of the table within the epsilons.
    bool Equal(int number, const Vec3d &normal, double dist) const;
    /// True when the normal is along an axis.
    bool IsAxial(int number) const;
    /// Snaps a normal that is nearly along an axis or in a coordinate plane. True when it changed.
    bool SnapNormal(Vec3d &normal) const;

  private:
    static constexpr std::size_t kHashes = 8192;
    int Append(const Vec3d &normal, double dist);

    double normalEpsilon_, distanceEpsilon_;
    std::vector<Plane> planes_;
    std::vector<int> chains_, next_; ///< newest first
};

} // namespace q3
