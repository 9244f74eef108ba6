// GPL-2.0-or-later. Light at points of the lattice of the sparse SH grid.
#pragma once

#include "q3map2/light/grid/gridsh_fill.h"
#include "q3map2/light/sparse/sparse_lattice.h"

#include <array>
#include <vector>

namespace q3 {

struct LitPoint {
    LatticePoint at{};
    bool open = false; ///< lit by rays; else in a solid, with a value that follows from others
    ShFloats value{};
};

/// The points that are known so far, by their numbers, in the order in which they were added.
class LatticePoints {
  public:
    static constexpr std::uint32_t kUnknown = std::uint32_t(-1);
    explicit LatticePoints(const SparseLattice &lattice);
    /// Makes room for points in all.
    void Reserve(std::size_t points) { points_.reserve(points); }
    /// Adds a point, without light, unless it is known. Returns its number.
    std::uint32_t Add(const LatticePoint &at);
    /// Number of a point, or kUnknown.
    std::uint32_t Find(const LatticePoint &at) const;
    /// Of a point that is known.
    const LitPoint &At(const LatticePoint &at) const { return points_[Find(at)]; }
    LitPoint &operator[](std::size_t number) { return points_[number]; }
    const LitPoint &operator[](std::size_t number) const { return points_[number]; }
    std::size_t Size() const { return points_.size(); }

  private:
    /// Where the number of a point of the uniform grid's lattice is, in the roots' box; else null.
    const std::uint32_t *UniformNumber(const LatticePoint &at) const;
    struct Slot {
        std::uint64_t key = 0;
        std::uint32_t number = kUnknown;
    };
    /// Of the key, or the free one where it belongs.
    std::size_t SlotOf(std::uint64_t key) const;
    void Grow();

    std::vector<LitPoint> points_;
    int baseLevel_;
    Int3 uniformSize_{};                 ///< points by axis
    std::vector<std::uint32_t> uniform_; ///< numbers by place: most points are of this lattice
    std::vector<Slot> slots_;            ///< of all others: hash table with linear probing; size: a power of two
    std::size_t hashed_ = 0;             ///< numbers in it
};

/// Unique for coordinates below 2^21.
inline std::uint64_t KeyOf(const LatticePoint &p) {
    return std::uint64_t(std::uint32_t(p[0])) | std::uint64_t(std::uint32_t(p[1])) << 21 |
           std::uint64_t(std::uint32_t(p[2])) << 42;
}

} // namespace q3
