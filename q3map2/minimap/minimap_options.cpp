// GPL-2.0-or-later. Options of the minimap stage.
#include "q3map2/minimap/minimap_options.h"

#include "common/error.h"
#include "common/text/text.h"

#include <algorithm>

namespace q3 {

namespace {

constexpr double kDarkPlacesBorder = 1.0 / 66; ///< fraction of the image
constexpr std::string_view kDarkPlacesOutput = "../gfx/{}_mini.tga";

constexpr MinimapStyle kMinimapStyles[] = {
    {},
    {.game = "nexuiz", .border = kDarkPlacesBorder, .output = kDarkPlacesOutput},
    {.game = "xonotic", .border = kDarkPlacesBorder, .output = kDarkPlacesOutput},
    {.game = "unvanquished", .pixels = MinimapPixels::White, .output = "../minimaps/{}.tga", .sidecar = true},
};

constexpr SettingRange kMinimapSizes{1, 16384}, kMinimapSamples{1, 1024};

void SetBox(MinimapOptions &options, const SettingValues &values) {
    const auto &n = values.numbers;
    options.box = Boundsd{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
}

SettingGroup<MinimapOptions> MinimapImageSettings() {
    return {
        "Image",
        "",
        {{{.name = "-size", .values = "N", .unit = "pixels", .range = kMinimapSizes, .help = "Width and height"},
          &MinimapOptions::size},
         {{.name = "-border",
           .values = "F",
           .initial = "0; nexuiz, xonotic 1/66",
           .range = {.low = 0, .high = 0.5, .belowHigh = true},
           .help = "Share of the image that is left free on each side"},
          &MinimapOptions::border},
         {{.name = "-keepaspect", .help = "Widen the shorter side of the map to a square"},
          &MinimapOptions::keepAspect},
         {{.name = "-nokeepaspect", .help = "Stretch the map to the square image"}, Off(&MinimapOptions::keepAspect)},
         {{.name = "-minmax",
           .values = "X Y Z X Y Z",
           .kind = SettingKind::Number,
           .unit = "game units",
           .initial = "the world's",
           .help = "Lowest and highest corner of the box that is drawn"},
          Do<MinimapOptions>(SetBox)},
         {{.name = "-gray", .initial = "this; unvanquished -white", .help = "Pixels of 8 bits: the value"},
          &MinimapOptions::gray},
         {{.name = "-black", .help = "Black pixels of 32 bits with the value as alpha"}, &MinimapOptions::black},
         {{.name = "-white", .help = "White pixels of 32 bits with the value as alpha"}, &MinimapOptions::white},
         {{.name = "-o",
           .values = "FILE",
           .initial = "x.tga; nexuiz, xonotic ../gfx/x_mini.tga; unvanquished ../minimaps/x.tga",
           .help = "The image; a default is relative to the folder of the map"},
          &MinimapOptions::output}}};
}

SettingGroup<MinimapOptions> MinimapValueSettings() {
    return {"Values",
            "The value of a pixel is the thickness of solids along a vertical line, divided by the height of the box. "
            "These act on it in the order in which they stand here.",
            {{{.name = "-samples",
               .values = "N",
               .range = kMinimapSamples,
               .help = "Vertical lines a pixel, at the same places in all, spread evenly"},
              &MinimapOptions::samples},
             {{.name = "-random",
               .values = "N",
               .initial = "off",
               .range = kMinimapSamples,
               .help = "Vertical lines a pixel, at random places up to a pixel from its middle"},
              &MinimapOptions::randomSamples},
             {{.name = "-boost",
               .values = "F",
               .range = {.low = 0, .aboveLow = true},
               .help = "Raises (over 1) or lowers low values: v becomes v F / ((F - 1) v + 1)"},
              &MinimapOptions::boost},
             {{.name = "-autolevel", .help = "Stretch values to 0..1"}, &MinimapOptions::autoLevel},
             {{.name = "-noautolevel", .help = "Leave the range of values as it is (default)"},
              Off(&MinimapOptions::autoLevel)},
             {{.name = "-contrast", .values = "F", .help = "Factor of values"}, &MinimapOptions::contrast},
             {{.name = "-brightness", .values = "F", .help = "Added to values"}, &MinimapOptions::brightness},
             {{.name = "-sharpen",
               .values = "F",
               .help = "Weight of the difference from the eight pixels around; below 0: none"},
              &MinimapOptions::sharpen}}};
}

} // namespace

const MinimapStyle &MinimapStyleOf(std::string_view game) {
    const auto found = std::ranges::find_if(kMinimapStyles, [&](const MinimapStyle &style) {
        return !style.game.empty() && EqualNoCase(style.game, game);
    });
    return found == std::end(kMinimapStyles) ? kMinimapStyles[0] : *found;
}

MinimapPixels MinimapOptions::Pixels(const MinimapStyle &style) const {
    return gray ? MinimapPixels::Gray : black ? MinimapPixels::Black : white ? MinimapPixels::White : style.pixels;
}

std::filesystem::path MinimapOptions::Output(const MinimapStyle &style, const std::filesystem::path &bspPath) const {
    if (!output.empty())
        return std::filesystem::absolute(output);
    std::string name(style.output);
    name.replace(name.find("{}"), 2, bspPath.stem().string());
    return (bspPath.parent_path() / name).lexically_normal();
}

std::vector<SettingGroup<MinimapOptions>> MinimapSettings() {
    return {MinimapImageSettings(), MinimapValueSettings()};
}

MinimapOptions ParseMinimapOptions(Arguments &arguments, Log &log) {
    MinimapOptions options;
    TakeSettings(MinimapSettings(), options, arguments, log);
    if (int(options.gray) + int(options.black) + int(options.white) > 1)
        throw Error("-minimap: -gray, -black and -white exclude each other");
    if (options.samples > 1 && options.randomSamples > 0)
        throw Error("-minimap: -samples and -random exclude each other");
    if (const auto &box = options.box;
        box && !(box->mins.x < box->maxs.x && box->mins.y < box->maxs.y && box->mins.z < box->maxs.z))
        throw Error("-minimap: -minmax {} {} {} {} {} {}: expected the lowest corner, then the highest", box->mins.x,
                    box->mins.y, box->mins.z, box->maxs.x, box->maxs.y, box->maxs.z);
    return options;
}

} // namespace q3
