// GPL-2.0-or-later. The plane table of a compile, which becomes the planes lump.
#pragma once

#include "libs/math/winding.h"

#include <array>
#include <span>
#include <vector>

namespace q3 {

/// The number of the plane with the opposite normal, in a PlaneTable.
constexpr int OppositePlane(int planeNum) {
    return planeNum ^ 1;
}
/// The even number of a pair of opposite planes.
constexpr int EvenPlane(int planeNum) {
    return planeNum & ~1;
}

/// Planes in pairs: 2 i and 2 i + 1 are opposite. In axial pairs the even number has the positive normal. Stored with
/// the precision of float. Find snaps normals to a nearby axis or coordinate plane, and distances of axial planes to
/// nearby whole numbers.
class PlaneTable {
  public:
    PlaneTable(double normalEpsilon, double distanceEpsilon)
        : normalEpsilon_(normalEpsilon), distanceEpsilon_(distanceEpsilon), chains_(kHashes, -1) {}

    /// Number of the plane, found or appended. `points` lie on it and must stay within the distance epsilon of a match.
    /// -1: the normal is shorter than 0.5, or a value is not finite.
    int Find(const Vec3d &normal, double dist, std::span<const Vec3d> points = {});
    /// Float values, held in double.
    const Plane &operator[](int number) const { return planes_[std::size_t(number)]; }
    int Count() const { return int(planes_.size()); }
    /// Whether plane `number` of the table has this normal and distance within the epsilons.
    bool Equal(int number, const Vec3d &normal, double dist) const;
    /// True when the normal is along an axis.
    bool IsAxial(int number) const;
    /// Snaps a normal that is nearly along an axis or in a coordinate plane. True when it changed.
    bool SnapNormal(Vec3d &normal) const;

  private:
    static constexpr std::size_t kHashes = 8192; ///< number of hash chains, chosen
    int Append(const Vec3d &normal, double dist);

    double normalEpsilon_, distanceEpsilon_;
    std::vector<Plane> planes_;
    std::vector<int> chains_, next_; ///< hash chains, newest plane first
};

} // namespace q3
