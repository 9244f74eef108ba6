// GPL-2.0-or-later. Traces light at points of the lattice of the sparse SH grid.
#pragma once

#include "q3map2/light/grid/smooth_light.h"
#include "q3map2/light/sparse/lattice_points.h"

#include <span>

namespace q3 {

/// Morton code: points next to each other in this order are near to each other in space.
std::uint64_t MortonOf(const LatticePoint &p);

/// Traces light at lattice points in the open. Const after construction; keeps references.
class LatticeTracer {
  public:
    LatticeTracer(const GridInputs &in, const SmoothLight &light, const SparseLattice &lattice)
        : in_(in), light_(light), lattice_(lattice) {}
    /// Sets the light of the points from number `first` on that are in the open or a small step from it, and their
    /// `open`. The others keep value 0. Adds the work to `stats`.
    void Trace(LatticePoints &points, std::size_t first, GridStats &stats) const;

  private:
    void TraceBrick(LatticePoints &points, std::span<const std::uint32_t> numbers, GridStats &work) const;

    const GridInputs &in_;
    const SmoothLight &light_;
    const SparseLattice &lattice_;
};

} // namespace q3
