// GPL-2.0-or-later. Numbers for points in space, equal ones within a tolerance.
#pragma once

#include "libs/math/vec.h"

#include <cstddef>
#include <unordered_map>
#include <vector>

namespace q3 {

/// Finds by hashing what a search through all points in order of addition would find first.
class PointTable {
  public:
    /// Points are the same when no coordinate differs by more than `tolerance`, which is less than an eighth.
    explicit PointTable(double tolerance) : tolerance_(tolerance) {}
    /// Number of the first point that is the same, or of the new one.
    int FindOrAdd(const Vec3f &p);
    int Count() const { return int(points_.size()); }

  private:
    struct Cell {
        long long x, y, z;
        bool operator==(const Cell &) const = default;
    };
    struct CellHash {
        std::size_t operator()(const Cell &c) const;
    };
    Cell CellOf(const Vec3f &p, double x, double y, double z) const;
    int FindIn(const Cell &cell, const Vec3f &p) const;

    double tolerance_;
    std::vector<Vec3f> points_;
    std::unordered_map<Cell, std::vector<int>, CellHash> cells_;
};

} // namespace q3
