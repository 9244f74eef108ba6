// GPL-2.0-or-later. Light at points of the lattice of the sparse SH grid, traced where it is asked for.
#pragma once

#include "q3map2/light/grid/gridsh_fill.h"
#include "q3map2/light/grid/probe_integrator.h"
#include "q3map2/light/sparse/sparse_lattice.h"

#include <array>
#include <span>
#include <vector>

namespace q3 {

/// Coefficients of a point: coefficient k of a channel is at 3 k + channel. 1 = byte 255.
using ShFloats = std::array<float, kShFloats>;

struct LitPoint {
    LatticePoint at{};
    bool open = false; ///< lit by rays; else in a solid, with a value that follows from others
    ShFloats value{};
};

/// The points that are known so far, by their numbers, in the order in which they were added.
class LatticeLight {
  public:
    static constexpr std::uint32_t kUnknown = std::uint32_t(-1);
    /// Keeps references.
    LatticeLight(const GridInputs &in, const ProbeIntegrator &integrator, const SparseLattice &lattice)
        : in_(in), integrator_(integrator), lattice_(lattice) {}
    /// Adds a point with its light.
    void Add(const LitPoint &point);
    /// Adds a point unless it is known. Light gives it its light.
    void Ask(const LatticePoint &at);
    /// Lights the points asked for that are in the open or a small step beside it. The others get value 0. Returns the
    /// number of the first of them.
    std::size_t Light(GridStats &stats);
    /// Number of a point, or kUnknown.
    std::uint32_t Find(const LatticePoint &at) const;
    /// Of a point that is known.
    const LitPoint &At(const LatticePoint &at) const { return points_[Find(at)]; }
    LitPoint &operator[](std::size_t number) { return points_[number]; }
    const LitPoint &operator[](std::size_t number) const { return points_[number]; }
    std::size_t Size() const { return points_.size(); }

  private:
    struct Slot {
        std::uint64_t key = 0;
        std::uint32_t number = kUnknown;
    };
    /// Of the key, or the free one where it belongs.
    std::size_t SlotOf(std::uint64_t key) const;
    void Grow();
    /// Lights the points of these numbers.
    void Trace(std::span<const std::uint32_t> numbers, GridStats &work);

    const GridInputs &in_;
    const ProbeIntegrator &integrator_;
    const SparseLattice &lattice_;
    std::vector<LitPoint> points_;
    std::size_t lit_ = 0;     ///< points from here on are not lit yet
    std::vector<Slot> slots_; ///< hash table with linear probing; size: a power of two
};

} // namespace q3
