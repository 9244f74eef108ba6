// GPL-2.0-or-later. Minimaps: pictures of a map from above, of how thick its solids are.
#pragma once

#include "common/jobs.h"
#include "common/log.h"
#include "libs/math/vec.h"
#include "libs/math/winding.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/minimap/minimap_options.h"
#include "q3map2/shader/shader_library.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace q3 {

/// A convex solid: what is behind all planes.
struct MinimapSolid {
    std::vector<Plane> planes;
    Boundsd bounds; ///< of the planes along x and y; infinite where there are none

    /// Length of the vertical line through (x, y) in the solid, game units.
    double Thickness(double x, double y) const;
};

/// World brushes with a solid side and without a sky side.
std::vector<MinimapSolid> MinimapSolids(const Bsp &bsp, ShaderLibrary &library);

/// Values of pixels, `size` a row; row 0 has the lowest y.
struct MinimapValues {
    int size = 0;
    std::vector<float> values;
};

struct Minimap {
    Boundsd box; ///< that the image covers, game units
    MinimapValues image;
};

/// The box widened to a square in x and y (with keepAspect), then along all axes by so much that `border` of the image
/// on each side lies outside. border: 0 <= border < 0.5.
Boundsd MinimapBox(Boundsd box, bool keepAspect, double border);

/// Values for the options, before they become bytes. Prints the box before and after it is widened. Errors: a world
/// without height, width or depth.
Minimap DrawMinimap(const Bsp &bsp, ShaderLibrary &library, const MinimapOptions &options, const MinimapStyle &style,
                    const JobPool &jobs, Log &log);

/// Bytes of values, 0..255 for 0..1. Values outside become the nearest.
std::vector<std::uint8_t> MinimapBytes(std::span<const float> values);
/// A TGA file, the first row at the bottom. Without compression.
std::vector<std::byte> MinimapTga(const MinimapValues &image, MinimapPixels pixels);
/// Text of the file that tells a game of what part of the world the image is. `name`: of the image, without folder and
/// extension.
std::string MinimapSidecar(const Boundsd &box, std::string_view name);

/// Draws the minimap and writes it, and the game's text file beside it; makes the folder if need be. `bspPath` is
/// absolute. Errors: those of DrawMinimap, and files that cannot be written.
void WriteMinimap(const Bsp &bsp, const std::filesystem::path &bspPath, ShaderLibrary &library,
                  const MinimapOptions &options, const MinimapStyle &style, const JobPool &jobs, Log &log);

/// Boost, automatic level, brightness and contrast, in this order, then sharpening.
void ApplyMinimapLevels(MinimapValues &image, const MinimapOptions &options, Log &log);

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
