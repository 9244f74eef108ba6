// GPL-2.0-or-later. The lattice of the sparse SH grid: positions of its points, and the light that is known there.
#pragma once

#include "common/parallel.h"
#include "libs/math/morton.h"
#include "libs/math/vec.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/light/grid/gridsh_fill.h"
#include "q3map2/light/grid/weak_field.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

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
    /// light near a light changes as fast with height as sideways. Edges are not halved below kMinCubicCell.
    static SparseLattice Cubic(const bspGridSHHeader_t &uniform);
    /// A lattice whose smallest cells are those of the uniform grid.
    static SparseLattice OfUniformCells(const bspGridSHHeader_t &uniform) { return SparseLattice(uniform, Int3{}); }
    /// Level of the smallest cells that have points of the uniform grid at all corners.
    int BaseLevel() const { return baseLevel_; }
    /// Distance of points of the uniform grid along an axis: 2^UniformLevel smallest cells.
    int UniformLevel(std::size_t axis) const { return uniformLevel_[axis]; }
    /// Level of the roots: their edge is 2^Levels smallest cells.
    int Levels() const { return levels_; }
    Vec3f UniformMins() const { return Vec3f(uniform_.gridMins); } ///< first point of the uniform grid
    const Vec3f &Mins() const { return mins_; }                    ///< lower corner of the roots
    const Vec3f &Cell() const { return cell_; }                    ///< edges of the smallest cells, game units
    const Int3 &Roots() const { return roots_; }                   ///< number of roots by axis
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
    LatticePoint first_{}; ///< the first point of the uniform grid
};

/// Light at a point of the lattice.
struct LatticeSample {
    LatticePoint at{};
    bool traced = false; ///< in the open, with traced light; else in a solid, with a value extrapolated from others
    SHFloats value{};    ///< convolved with the cosine
};

/// Light at a position near a light: NearLightSet.
struct NearLightSample {
    Vec3f at;         ///< in smallest cells
    SHFloats light{}; ///< convolved with the cosine
};

/// A set of lattice points with their light. Points have numbers, in the order in which they were added.
class LatticePoints {
  public:
    static constexpr std::uint32_t kUnknown = std::uint32_t(-1);
    explicit LatticePoints(const SparseLattice &lattice);
    /// Gets memory for at least that many points.
    void Reserve(std::size_t points, const JobPool &jobs) { points_.Reserve(points, jobs); }
    /// Adds points of the uniform grid's lattice, without light, to an empty set. forEach(use) calls use(point) for
    /// each of them, in the order of their numbers; a point may occur more than once.
    template <typename ForEach> void AddUniform(const ForEach &forEach, const JobPool &jobs) {
        std::uint32_t count = 0; // first all are counted, since they take much memory
        forEach([&](const LatticePoint &at) {
            if (std::uint32_t &number = uniform_[UniformPlace(at)]; number == kUnknown)
                number = count++;
        });
        MakeUniform(count, jobs);
    }
    /// Adds a point, without light, unless it is in the set. Returns its number.
    std::uint32_t Add(const LatticePoint &at);
    /// Number of a point; kUnknown if it is not in the set.
    std::uint32_t Find(const LatticePoint &at) const;
    /// at: of a point in the set.
    const LatticeSample &At(const LatticePoint &at) const { return points_[Find(at)]; }
    LatticeSample &operator[](std::size_t number) { return points_[number]; }
    const LatticeSample &operator[](std::size_t number) const { return points_[number]; }
    std::size_t Size() const { return points_.Size(); }

  private:
    static constexpr std::size_t kNoPlace = std::size_t(-1);
    /// Index in uniform_ of a point; kNoPlace if it is not of the uniform grid's lattice, or outside the roots.
    std::size_t UniformPlace(const LatticePoint &at) const;
    /// Makes the samples of the points that have numbers in uniform_, which are 0 to count - 1.
    void MakeUniform(std::size_t count, const JobPool &jobs);
    /// Of the hash table. It says which point may be meant; whether it is shows the point itself.
    struct Slot {
        std::uint32_t hash = 0;
        std::uint32_t number = kUnknown;
    };
    static std::uint32_t HashOf(const LatticePoint &at);
    /// Puts a number that is not in the table into it.
    void Insert(const Slot &inserted);
    /// Enlarges the hash table once half of it is in use.
    void GrowIfFull();

    ChunkedVector<LatticeSample> points_;
    Int3 uniformLevel_{};                ///< log2 of the distance of points of the uniform grid, by axis
    Int3 uniformSize_{};                 ///< of uniform_, by axis
    std::vector<std::uint32_t> uniform_; ///< numbers of points of the uniform grid's lattice, as an array: most are
    std::vector<Slot> slots_;            ///< of all others: hash table with linear probing; size: a power of two
    std::size_t hashed_ = 0;             ///< slots in use
};

/// Light at the corners of a cell, by number of the corner; null where it is not known.
using CornerLight = std::array<const SHFloats *, 8>;

/// Hash key of a point, unique for coordinates below 2^21.
inline std::uint64_t KeyOf(const LatticePoint &p) {
    return std::uint64_t(std::uint32_t(p[0])) | std::uint64_t(std::uint32_t(p[1])) << 21 |
           std::uint64_t(std::uint32_t(p[2])) << 42;
}

/// Morton code of a point.
inline std::uint64_t MortonOf(const LatticePoint &p) {
    return MortonCode(std::uint32_t(p[0]), std::uint32_t(p[1]), std::uint32_t(p[2]));
}

/// Traces light at lattice points in the open. Const after construction; keeps references.
class LatticeTracer {
  public:
    LatticeTracer(const GridInputs &in, const LightAtPositions &light, const SparseLattice &lattice)
        : in_(in), light_(light), lattice_(lattice) {}
    /// Sets the light of the points from number `first` on that are in the open or a small step from it, and their
    /// `traced`. The others keep value 0. Adds the work to `stats`.
    void Trace(LatticePoints &points, std::size_t first, GridStats &stats) const;

  private:
    void TraceBrick(LatticePoints &points, std::span<const std::uint32_t> numbers, GridStats &work) const;

    const GridInputs &in_;
    const LightAtPositions &light_;
    const SparseLattice &lattice_;
};

} // namespace q3
