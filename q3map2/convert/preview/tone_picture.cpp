// GPL-2.0-or-later. HDR images as ordinary pictures.
#include "q3map2/convert/preview/tone_picture.h"

#include "q3map2/shader/image_formats.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

constexpr std::string_view kFilmic = "filmic";
constexpr double kMostStops = 64;   ///< limit of -exposure, chosen
constexpr float kMostLight = 1e30f; ///< infinity becomes this, so that ratios of channels stay numbers

/// The ACES curve as fitted by Narkowicz, "ACES Filmic Tone Mapping Curve", 2016: 0.8 at 1, never above 1.
float FilmicCurve(float m) {
    const float x = std::min(m, 1e4f); // above, the curve is level
    return std::min(1.0f, x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f));
}

std::uint8_t SrgbByte(float linear) {
    return std::uint8_t(std::clamp(SrgbFromLinear(linear), 0.0f, 1.0f) * 255 + 0.5f);
}

} // namespace

std::vector<SettingGroup<ToneMapOptions>> ToneMapSettings() {
    return {{"Picture",
             "",
             {{{.name = "-exposure",
                .values = "EV",
                .unit = "stops",
                .range = {-kMostStops, kMostStops},
                .help = "Sets the exposure in stops, each of which doubles the light",
                .since = "0.1.0",
                .example = "-2"},
               &ToneMapOptions::exposure},
              {{.name = "-operator",
                .values = "filmic|clamp",
                .kind = SettingKind::Choice,
                .help = "Chooses how light above 1 is limited",
                .details =
                    "Both operators scale a color as a whole, by its largest channel, so hue and saturation stay. The "
                    "word `filmic` compresses all light by a fit of the ACES curve, where 1 becomes 0.8 and 4 becomes "
                    "0.97. The word `clamp` leaves light up to 1 as it is, and shows no differences above.",
                .since = "0.2.0",
                .example = "clamp"},
               &ToneMapOptions::toneOperator},
              {{.name = "-page",
                .values = "N",
                .range = {0, kMaxSetting},
                .help = "Chooses the lightmap of a .bsp",
                .since = "0.2.0",
                .example = "1"},
               &ToneMapOptions::page}}}};
}

ToneMapOptions ParseToneMapOptions(Arguments &arguments, Log &log) {
    ToneMapOptions options;
    TakeSettings(ToneMapSettings(), options, arguments, log);
    return options;
}

Image ToneMapped(const FloatImage &image, const ToneMapOptions &options) {
    const float factor = float(std::exp2(options.exposure));
    const auto channel = [factor](float value) { return value > 0 ? std::min(value * factor, kMostLight) : 0.0f; };
    Image picture{image.width, image.height, {}};
    picture.rgba.reserve(4 * image.texels.size());
    for (const Vec3f &texel : image.texels) {
        Vec3f color(channel(texel.x), channel(texel.y), channel(texel.z));
        if (const float m = MaxComponent(color); m > 0)
            color *= (options.toneOperator == kFilmic ? FilmicCurve(m) : std::min(m, 1.0f)) / m;
        for (const float value : color.Array())
            picture.rgba.push_back(SrgbByte(value));
        picture.rgba.push_back(255);
    }
    return picture;
}

} // namespace q3
