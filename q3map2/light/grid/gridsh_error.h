// GPL-2.0-or-later. Error of the SH grid against exact light, where players can be.
#pragma once

#include "libs/math/vec.h"
#include "libs/shgrid/shgrid.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/bspfile_sparse.h"
#include "q3map2/light/grid/light_grid.h"
#include "q3map2/light/sources/light_sources.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace q3 {

/// Light on surfaces that face the 26 faces, edges and corners of a cube, red green blue each: 0 to 255, not rounded.
using DisplayedLight = std::array<float, 26 * 3>;

/// Evaluates the coefficients as engines do. radiance: the coefficients are not yet convolved with the cosine.
inline DisplayedLight DisplayLight(shgrid_coeffs coeffs, bool radiance) {
    if (radiance)
        shgrid_convolve(&coeffs);
    DisplayedLight shown;
    std::size_t at = 0;
    for (int i = 0; i < 27; ++i) {
        const Vec3f n = Normalize(Vec3f{float(i % 3 - 1), float(i / 3 % 3 - 1), float(i / 9 - 1)});
        if (n == Vec3f{})
            continue;
        const float normal[3] = {n.x, n.y, n.z};
        float rgb[3];
        shgrid_evaluate(&coeffs, normal, rgb);
        for (const float light : rgb)
            shown[at++] = 255 * std::min(1.0f, light);
    }
    return shown;
}

/// The same for the coefficients of a grid point.
inline DisplayedLight DisplayLight(const bspGridPointSH_t &point, bool radiance) {
    shgrid_coeffs coeffs;
    for (std::size_t k = 0; k < 9; ++k)
        for (std::size_t channel = 0; channel < 3; ++channel)
            coeffs.c[k][channel] = point.coeffs[k][channel];
    return DisplayLight(coeffs, radiance);
}

/// Displayed light from the interpolated grid minus displayed light from a grid point at the same position. Both are
/// clamped to 0..255 first. In 255ths.
struct GridSHError {
    std::size_t receivers = 0; ///< 0: the values below are not set
    double rms = 0;            ///< over receivers, 26 directions and 3 channels
    double percentile95 = 0;   ///< of the absolute difference
    double leak = 0;    ///< fraction of receivers with less than 1 % of the map's mean light, shown with more than 5 %
    double doubled = 0; ///< percentile95 from every second point per axis, that is, with doubled cells
    double order = 2;   ///< percentile95 falls as this power of the cell size; 0.5 to 2
    double cpuSeconds = 0;
};

/// Receivers at which the error of a grid is measured, if there is space for so many.
inline constexpr std::size_t kErrorReceivers = 2000;

/// Compares `grid`, as stored, with the exact light of `lights` (from SetupEnvelopes for the SH grid) at random
/// receivers 16 units clear of solids, the same in every run. Fewer receivers where little space is open.
GridSHError MeasureGridSH(const GridInputs &in, const LightGridSH &grid, const std::vector<Light> &lights,
                          std::size_t receivers = kErrorReceivers);

/// Random receivers like those of MeasureGridSH with the exact light there, for comparison with any number of sparse
/// grids. Const after construction; keeps no references.
class ExactReceivers {
  public:
    ExactReceivers(const GridInputs &in, const std::vector<Light> &lights, std::size_t receivers = kErrorReceivers);
    std::size_t Size() const { return positions_.size(); }
    const Vec3f &Position(std::size_t receiver) const { return positions_[receiver]; }
    /// The exact light at a receiver, as grids store it.
    const bspGridPointSH_t &At(std::size_t receiver) const { return light_[receiver]; }
    /// Mean squared displayed error of the exact light itself, bytes^2: bounced light is gathered by few rays.
    double Noise() const { return noise_; }
    /// Error of a grid with Noise subtracted from its mean square; `doubled` and `order` are not set.
    GridSHError ErrorOf(const SparseGridSH &grid) const;
    /// The same of the lump of any form.
    GridSHError ErrorOf(std::span<const std::byte> lump) const;

  private:
    std::vector<Vec3f> positions_;
    std::vector<bspGridPointSH_t> light_;
    double noise_ = 0;
    bool radiance_;
};

/// Cell size at which percentile95 would be about half: whole units, at least 8. Not the RMS, which is dominated by a
/// few receivers close to bright lights, where smaller cells do not help.
Float3 CellOfHalfError(const Float3 &cell, const GridSHError &error);

/// Prints the error for mappers, with the options that would halve it.
void PrintGridSHError(const GridSHError &error, const Float3 &cell, const Float3 &legacyCell, Log &log);
/// The same of a sparse grid.
void PrintSparseGridError(const GridSHError &error, Log &log);

} // namespace q3
