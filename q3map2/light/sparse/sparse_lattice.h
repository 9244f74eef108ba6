// GPL-2.0-or-later. The lattice of the sparse SH grid: positions of its points, levels and roots of its octree.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bsp.h"

#include <array>
#include <cstdint>

namespace q3 {

/// A point of the lattice of the smallest cells: its coordinates in such cells, from the lower corner of the roots.
using LatticePoint = std::array<std::int32_t, 3>;

/// Least edge of the cells of SparseLattice::Cubic, game units.
inline constexpr float kMinCubicCell = 4;

/// The lattice of the smallest cells, laid so that points of the uniform SH grid are points of it. An octree over it
/// has roots of edge 2^levels; cells of level l have an edge of 2^l smallest cells; those of baseLevel are the smallest
/// that have points of the uniform grid at all corners.
class SparseLattice {
  public:
    /// uniform: header of the uniform grid. The smallest cells are its cells halved twice, or less often where an edge
    /// would fall below kMinCell; those of baseLevel are its cells.
    explicit SparseLattice(const bspGridSHHeader_t &uniform);
    /// A lattice of cells as near to cubes as halving the uniform grid's cells along single axes makes them, since
    /// light before a lamp changes as fast with height as sideways. Edges are not halved below kMinCubicCell.
    static SparseLattice Cubic(const bspGridSHHeader_t &uniform);
    int BaseLevel() const { return baseLevel_; }
    /// Distance of points of the uniform grid along an axis: 2^UniformLevel smallest cells.
    int UniformLevel(std::size_t axis) const { return uniformLevel_[axis]; }
    int Levels() const { return levels_; }
    Vec3f UniformMins() const { return Vec3f(uniform_.gridMins); } ///< first point of the uniform grid
    const Vec3f &Mins() const { return mins_; }
    const Vec3f &Cell() const { return cell_; }
    const Int3 &Roots() const { return roots_; }
    Vec3f PositionOf(const LatticePoint &p) const { return PositionOf(Vec3f{float(p[0]), float(p[1]), float(p[2])}); }
    Vec3f PositionOf(const Vec3f &inCells) const { return mins_ + cell_ * inCells; }
    /// Inverse of PositionOf.
    Vec3f InCells(const Vec3f &position) const {
        const Vec3f from = position - mins_;
        return {from.x / cell_.x, from.y / cell_.y, from.z / cell_.z};
    }
    /// Index of the point of the uniform grid at p; outside that grid, of the nearest of its points.
    std::size_t UniformIndex(const LatticePoint &p) const;

  private:
    SparseLattice(const bspGridSHHeader_t &uniform, const Int3 &uniformLevel);

    bspGridSHHeader_t uniform_;
    Int3 uniformLevel_{};
    int baseLevel_ = 0, levels_ = 0;
    Vec3f mins_, cell_;
    Int3 roots_{};
    LatticePoint first_{}; ///< of the first point of the uniform grid
};

} // namespace q3
