// GPL-2.0-or-later. Random error of bounced light at points of the SH grid.
#pragma once

#include "q3map2/light/grid/grid_pass.h"
#include "q3map2/light/sparse/lattice_points.h"

#include <vector>

namespace q3 {

/// Variance of bounced light at points of the lattice, since few rays gather it: the mean squared displayed difference
/// from its expected value, bytes^2. It is measured at some points of the uniform grid, by gathering light twice with
/// different rays, and averaged over blocks of cells.
class BounceNoise {
  public:
    /// No noise.
    BounceNoise() = default;
    /// points: those of the uniform grid. Zero if `in` has no bounced light.
    BounceNoise(const GridInputs &in, const SparseLattice &lattice, const LatticePoints &points);
    float At(const LatticePoint &p) const { return variance_.empty() ? 0 : variance_[BlockOf(p)]; }

  private:
    std::size_t BlockOf(const LatticePoint &p) const;

    int blockLevel_ = 0;
    Int3 blocks_{};
    std::vector<float> variance_; ///< by block
};

} // namespace q3
