// GPL-2.0-or-later. Difference of two lights as a screen shows them, and the random error of bounced light.
#pragma once

#include "libs/sh/sh.h"
#include "q3map2/light/batch/lanes.h"
#include "q3map2/light/grid/grid_bricks.h"
#include "q3map2/light/grid/probe_integrator.h"
#include "q3map2/light/sparse/lattice.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numbers>
#include <vector>

namespace q3 {

/// Cosine-convolved coefficients of stored ones. radiance: the stored ones are not convolved yet (-shradiance).
inline SHFloats ToDisplayed(const bspGridPointSH_t &stored, bool radiance) {
    auto light = std::bit_cast<SHFloats>(stored);
    for (std::size_t i = 0; radiance && i < kSHFloats; ++i)
        light[i] *= float(kCosineLobe[i / 3]);
    return light;
}
/// Inverse of ToDisplayed.
inline bspGridPointSH_t ToStored(SHFloats light, bool radiance) {
    for (std::size_t i = 0; radiance && i < kSHFloats; ++i)
        light[i] /= float(kCosineLobe[i / 3]);
    return std::bit_cast<bspGridPointSH_t>(light);
}

/// Factor that limits light to about what a screen shows: light whose mean over all normals is above 1 / kPeakToMean is
/// scaled down to that mean, at which its brightest side is about white (1).
inline float ScreenFactor(const SHFloats &light) {
    constexpr float kPeakToMean = 2.2f; // assumed ratio of the light on the brightest side to the mean
    return 1 / std::max(1.0f, kPeakToMean * MeanLight(light));
}

/// Mean squared difference of the displayed light of surfaces, over all normals and the three channels, bytes^2:
///
///     255^2 / (3 * 4 pi) |a' - b'|^2, a' = ScreenFactor(a) a, b' likewise
///
/// since, in an orthonormal basis, the squared distance of the coefficients is the integral over the sphere (Parseval).
inline float SquaredDisplayError(const SHFloats &a, const SHFloats &b) {
    constexpr float kScale = 255 * 255 / (3 * 4 * std::numbers::pi_v<float>);
    const float dimA = ScreenFactor(a), dimB = ScreenFactor(b);
    float sum = 0;
    for (std::size_t i = 0; i < kSHFloats; ++i)
        sum += (dimA * a[i] - dimB * b[i]) * (dimA * a[i] - dimB * b[i]);
    return sum * kScale;
}

/// Compares light on surfaces with 26 normals: those towards the faces, edges and corners of a cube.
/// SquaredDisplayError dims light as a whole that is too bright for a screen; here only the normals that are too bright
/// are cut off.
class ScreenError {
  public:
    ScreenError();
    /// Mean squared difference over normals and channels, bytes^2. a, b: convolved with the cosine.
    float Squared(const SHFloats &a, const SHFloats &b) const;

  private:
    std::array<Lanes, 9> basis_; ///< by coefficient: its basis function at 13 of the normals; the others are opposite
};

/// Variance of bounced light at points of the lattice, since few rays gather it: the mean squared displayed difference
/// from its expected value, bytes^2. It is measured at some points of the uniform grid, by gathering light twice with
/// different rays, and averaged over blocks of cells.
class BounceNoise {
  public:
    /// Variance 0 everywhere.
    BounceNoise() = default;
    /// points: those of the uniform grid. Zero if `in` has no bounced light.
    BounceNoise(const GridInputs &in, const SparseLattice &lattice, const LatticePoints &points);
    /// Variance at p, bytes^2.
    float At(const LatticePoint &p) const { return variance_.empty() ? 0 : variance_[BlockOf(p)]; }

  private:
    std::size_t BlockOf(const LatticePoint &p) const;

    int blockLevel_ = 0;          ///< edge of a block: 2^blockLevel_ smallest cells
    Int3 blocks_{};               ///< number of blocks by axis
    std::vector<float> variance_; ///< by block
};

} // namespace q3
