// GPL-2.0-or-later. Spatial hash of points, equal within a tolerance.
#pragma once

#include "libs/math/vec.h"

#include <cstddef>
#include <unordered_map>
#include <vector>

namespace q3 {

/// Spatial hash of points. Finds what a linear search in order of addition would find.
class PointTable {
  public:
    /// Points are equal if no coordinate differs by more than `tolerance`, which should be below 1/8.
    explicit PointTable(double tolerance) : tolerance_(tolerance) {}
    /// Index of the first equal point; if there is none, `p` is added.
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
