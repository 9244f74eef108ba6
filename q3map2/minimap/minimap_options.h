// GPL-2.0-or-later. Options of the minimap stage.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "common/settings.h"
#include "libs/math/vec.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

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
    double sharpen = 1;           ///< strength; negative: none
    int samples = 1;              ///< a pixel, the same places in each
    int randomSamples = 0;        ///< a pixel, other places in each; 0: `samples` counts
    std::optional<double> border; ///< fraction of the image on each side; unset: that of the game
    bool keepAspect = true;
    std::string output;                              ///< path of the image; empty: that of the game
    std::optional<Boundsd> box;                      ///< what is drawn, game units; unset: the world
    bool gray = false, black = false, white = false; ///< at most one; none: that of the game
    double boost = 1, brightness = 0, contrast = 1;
    bool autoLevel = false;

    double Border(const MinimapStyle &style) const { return border.value_or(style.border); }
    MinimapPixels Pixels(const MinimapStyle &style) const;
    /// Where the image goes. `bspPath` is absolute.
    std::filesystem::path Output(const MinimapStyle &style, const std::filesystem::path &bspPath) const;
};

/// The options of the minimap stage, declared.
std::vector<SettingGroup<MinimapOptions>> MinimapSettings();
/// Takes them off `arguments`. Errors: two kinds of pixels or of samples, a box that is empty.
MinimapOptions ParseMinimapOptions(Arguments &arguments, Log &log);

} // namespace q3
