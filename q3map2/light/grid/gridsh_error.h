// GPL-2.0-or-later. Error of the SH grid against exact light, where players can be.
#pragma once

#include "q3map2/bspfile/sparse_grid.h"
#include "q3map2/light/grid/light_grid.h"
#include "q3map2/light/sources/light_sources.h"

#include <cstddef>
#include <vector>

namespace q3 {

/// Displayed light from the interpolated grid minus displayed light from a grid point at the same position. Both are
/// clamped to 0..255 first. In 255ths.
struct GridSHError {
    std::size_t receivers = 0; ///< 0: the values below are not set
    double rms = 0;            ///< over receivers, 26 directions and 3 channels
    double percentile95 = 0;   ///< of the absolute difference
    double leak = 0;    ///< share of receivers with less than 1 % of the map's mean light, shown with more than 5 %
    double doubled = 0; ///< percentile95 from every second point per axis, that is, with doubled cells
    double order = 2;   ///< percentile95 falls as this power of the cell size; 0.5 to 2
    double cpuSeconds = 0;
};

/// Compares `grid`, as stored, with the exact light of `lights` (from SetupEnvelopes for the SH grid) at random
/// receivers 16 units clear of solids, the same in every run. Fewer receivers where little space is open.
GridSHError MeasureGridSH(const GridInputs &in, const LightGridSH &grid, const std::vector<Light> &lights,
                          std::size_t receivers = 2000);

/// Random receivers like those of MeasureGridSH with the exact light there, for comparison with any number of sparse
/// grids. Const after construction; keeps no references.
class ExactReceivers {
  public:
    ExactReceivers(const GridInputs &in, const std::vector<Light> &lights, std::size_t receivers = 2000);
    std::size_t Size() const { return positions_.size(); }
    const Vec3f &Position(std::size_t receiver) const { return positions_[receiver]; }
    /// The exact light at a receiver, as grids store it.
    const bspGridPointSH_t &At(std::size_t receiver) const { return light_[receiver]; }
    /// Mean squared displayed error of the exact light itself, bytes^2: bounced light is gathered by few rays.
    double Noise() const { return noise_; }
    /// Error of a grid with Noise subtracted from its mean square; `doubled` and `order` are not set.
    GridSHError ErrorOf(const SparseGridSH &grid) const;

  private:
    std::vector<Vec3f> positions_;
    std::vector<bspGridPointSH_t> light_;
    double noise_ = 0;
    bool radiance_;
};

/// Cell size at which percentile95 would be about half: whole units, at least 8. Not the RMS, which is dominated by a
/// few receivers close to bright lamps, where smaller cells do not help.
Float3 CellOfHalfError(const Float3 &cell, const GridSHError &error);

/// Prints the error for mappers, with the options that would halve it.
void PrintGridSHError(const GridSHError &error, const Float3 &cell, const Float3 &legacyCell, Log &log);
/// The same of a sparse grid.
void PrintSparseGridError(const GridSHError &error, Log &log);

} // namespace q3
