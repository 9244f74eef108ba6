// GPL-2.0-or-later. Traces light at points of the lattice of the sparse SH grid.
#pragma once

#include "q3map2/light/grid/smooth_light.h"
#include "q3map2/light/sparse/lattice_points.h"

#include <span>

namespace q3 {

/// Keeps references.
class LatticeTracer {
  public:
    LatticeTracer(const GridInputs &in, const SmoothLight &light, const SparseLattice &lattice)
        : in_(in), light_(light), lattice_(lattice) {}
    /// Lights the points from number `first` on that are in the open or a small step beside it. The others keep value
    /// 0.
    void Light(LatticePoints &points, std::size_t first, GridStats &stats) const;

  private:
    void Trace(LatticePoints &points, std::span<const std::uint32_t> numbers, GridStats &work) const;

    const GridInputs &in_;
    const SmoothLight &light_;
    const SparseLattice &lattice_;
};

} // namespace q3
