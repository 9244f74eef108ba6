// GPL-2.0-or-later. Where a pixel of a minimap is sampled. Internal to minimaps.
#pragma once

#include "q3map2/minimap/minimap_options.h"

#include <array>
#include <cstddef>
#include <vector>

namespace q3 {

/// An offset from the corner of a pixel with the lowest x and y, in pixels.
using PixelOffset = std::array<double, 2>;

/// `count` points of the unit square, as far from each other as a random search finds where the square repeats in both
/// directions. The same on every machine.
std::vector<PixelOffset> SpreadOffsets(std::size_t count);

/// Positions of the samples of all pixels.
class MinimapSampler {
  public:
    explicit MinimapSampler(const MinimapOptions &options);
    std::size_t Count() const { return count_; }
    /// Offset of a sample of pixel number `pixel`. Random ones lie up to 1 from the middle, so partly in neighbors.
    PixelOffset Offset(std::uint64_t pixel, std::size_t sample) const;

  private:
    std::size_t count_;
    std::vector<PixelOffset> fixed_; ///< empty: random
};

} // namespace q3
