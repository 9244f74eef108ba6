// GPL-2.0-or-later. Points in space with a tolerance, by hashing.
#pragma once

#include "libs/math/vec.h"

#include <cstddef>
#include <unordered_map>
#include <vector>

namespace q3 {

/// Spatial hash of points. Finds the same point as a linear search in order of addition.
class PointTable {
  public:
    /// Points are the same when no coordinate differs by more than `tolerance`, which is less than an eighth.
    explicit PointTable(double tolerance) : tolerance_(tolerance) {}
    /// Index of the first point that is the same, or of the new one.
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
