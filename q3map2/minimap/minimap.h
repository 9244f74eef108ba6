// GPL-2.0-or-later. Minimaps: pictures of a map from above, of how thick its solids are.
#pragma once

#include "common/arguments.h"
#include "common/jobs.h"
#include "common/log.h"
#include "common/settings.h"
#include "libs/math/vec.h"
#include "libs/math/winding.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/shader/shader_library.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// What a pixel of the image stores.
enum class MinimapPixels {
    Gray,  ///< 8 bits: the value
    Black, ///< 32 bits: black, with the value as alpha
    White  ///< 32 bits: white, with the value as alpha
};

/// What games expect of their minimaps.
struct MinimapStyle {
    std::string_view game; ///< as in -game; empty: all others
    double border = 0;     ///< fraction of the image on each side
    MinimapPixels pixels = MinimapPixels::Gray;
    std::string_view output = "{}.tga"; ///< relative to the folder of the .bsp, {} is the name of the map
    bool sidecar = false;               ///< a text file NAME.minimap beside the image
};

/// The style of that game (case-insensitive).
const MinimapStyle &MinimapStyleOf(std::string_view game);

struct MinimapOptions {
    int size = 512;               ///< pixels a side
    double sharpen = 1;           ///< weight of the difference from the eight pixels around; negative: none
    int samples = 1;              ///< a pixel, the same places in each
    int randomSamples = 0;        ///< a pixel, other places in each; 0: `samples` counts
    std::optional<double> border; ///< fraction of the image on each side; unset: that of the game
    bool keepAspect = true;       ///< the shorter side is widened to a square; else the map is stretched to one
    std::string output;           ///< path of the image; empty: that of the game
    std::optional<Boundsd> box;   ///< what is drawn, game units; unset: the world
    bool gray = false, black = false, white = false; ///< at most one; none: that of the game
    // What ApplyMinimapLevels does with values, in its order.
    double boost = 1;                    ///< v becomes v boost / ((boost - 1) v + 1)
    bool autoLevel = false;              ///< values are stretched to 0..1
    double brightness = 0, contrast = 1; ///< v becomes v contrast + brightness

    double Border(const MinimapStyle &style) const { return border.value_or(style.border); }
    MinimapPixels Pixels(const MinimapStyle &style) const;
    /// Where the image goes. `bspPath` is absolute.
    std::filesystem::path Output(const MinimapStyle &style, const std::filesystem::path &bspPath) const;
};

/// The options of the minimap stage, declared.
std::vector<SettingGroup<MinimapOptions>> MinimapSettings();
/// Takes them off `arguments`. Errors: two kinds of pixels or of samples, a box that is empty.
MinimapOptions ParseMinimapOptions(Arguments &arguments, Log &log);

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
