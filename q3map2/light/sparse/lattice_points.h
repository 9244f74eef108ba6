// GPL-2.0-or-later. The points of the lattice of the sparse SH grid at which light is known.
#pragma once

#include "q3map2/light/grid/gridsh_fill.h"
#include "q3map2/light/sparse/sparse_lattice.h"

#include <array>
#include <vector>

namespace q3 {

/// Light at a point of the lattice.
struct LatticeSample {
    LatticePoint at{};
    bool open = false; ///< in the open, with traced light; else in a solid, with a value extrapolated from others
    ShFloats value{};  ///< convolved with the cosine
};

/// Light at a position in front of a lamp: LampSamples.
struct LampSample {
    Vec3f at;         ///< in smallest cells
    ShFloats light{}; ///< convolved with the cosine
};

/// A set of lattice points with their light. Points have numbers, in the order in which they were added.
class LatticePoints {
  public:
    static constexpr std::uint32_t kUnknown = std::uint32_t(-1);
    explicit LatticePoints(const SparseLattice &lattice);
    /// Allocates memory for that many points.
    void Reserve(std::size_t points) { points_.reserve(points); }
    /// Adds a point, without light, unless it is in the set. Returns its number.
    std::uint32_t Add(const LatticePoint &at);
    /// Number of a point; kUnknown if it is not in the set.
    std::uint32_t Find(const LatticePoint &at) const;
    /// at: of a point in the set.
    const LatticeSample &At(const LatticePoint &at) const { return points_[Find(at)]; }
    LatticeSample &operator[](std::size_t number) { return points_[number]; }
    const LatticeSample &operator[](std::size_t number) const { return points_[number]; }
    std::size_t Size() const { return points_.size(); }

  private:
    /// Entry of uniform_ for a point; null if it is not of the uniform grid's lattice, or outside the roots.
    const std::uint32_t *UniformNumber(const LatticePoint &at) const;
    struct Slot {
        std::uint64_t key = 0;
        std::uint32_t number = kUnknown;
    };
    /// The slot with that key, else the free one in which to put it.
    std::size_t SlotOf(std::uint64_t key) const;
    /// Enlarges the hash table once half of it is in use.
    void GrowIfFull();

    std::vector<LatticeSample> points_;
    Int3 uniformLevel_{};                ///< log2 of the distance of points of the uniform grid, by axis
    Int3 uniformSize_{};                 ///< of uniform_, by axis
    std::vector<std::uint32_t> uniform_; ///< numbers of points of the uniform grid's lattice, as an array: most are
    std::vector<Slot> slots_;            ///< of all others: hash table with linear probing; size: a power of two
    std::size_t hashed_ = 0;             ///< slots in use
};

/// Light at the corners of a cell, by number of the corner; null where it is not known.
using CornerLight = std::array<const ShFloats *, 8>;

/// Hash key of a point, unique for coordinates below 2^21.
inline std::uint64_t KeyOf(const LatticePoint &p) {
    return std::uint64_t(std::uint32_t(p[0])) | std::uint64_t(std::uint32_t(p[1])) << 21 |
           std::uint64_t(std::uint32_t(p[2])) << 42;
}

} // namespace q3
