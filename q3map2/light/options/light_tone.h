// GPL-2.0-or-later. Float light to stored bytes.
#pragma once

#include "q3map2/light/options/light_options.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

namespace q3 {

/// The chain of NetRadiant's q3map2 from light on the byte scale to bytes: scale, contrast, gamma, exposure,
/// saturation, compensation, hue-preserving limit, sRGB, truncation; for many colors. Keeps a reference.
class ToneMapper {
  public:
    /// A scale or brightness of 0 or less counts as 1.
    ToneMapper(float scale, float brightness, const ToneOptions &tone)
        : tone_(tone), scale_(scale > 0 ? scale : 1), factor_(FactorOf(brightness, tone)),
          plain_(tone.contrast == 1 && tone.gamma == 1 && tone.exposure == 0 && tone.saturation == 1) {}

    /// NaN gives 0.
    std::array<std::uint8_t, 3> Bytes(const Vec3f &color) const {
        const Vec3f scaled = color * scale_;
        Vec3f v = (plain_ ? Max(scaled, {}) : Graded(scaled)) * factor_;
        if (const float m = MaxComponent(v); m > tone_.maxLight)
            v *= tone_.maxLight / m;
        if (tone_.sRgb)
            v = InSrgb(v);
        const auto byte = [](float c) { return std::uint8_t(int(std::min(std::max(0.0f, c), 255.0f))); };
        return {byte(v.x), byte(v.y), byte(v.z)};
    }

    /// The light that is stored as such values, 0 to 255; the inverse of Bytes but for what that cuts off: rounding,
    /// the limit, and parts that saturation and contrast make negative.
    Vec3f LightOf(const Vec3f &bytes) const;

    /// Factor on graded light: brightness / compensation.
    static float FactorOf(float brightness, const ToneOptions &tone) {
        return (brightness > 0 ? brightness : 1) / tone.compensate;
    }

  private:
    Vec3f Graded(const Vec3f &color) const;
    static Vec3f InSrgb(const Vec3f &color);

    const ToneOptions &tone_;
    float scale_, factor_;
    bool plain_; ///< contrast, gamma, exposure and saturation at their defaults, as in most maps
};

/// Tone-maps one color.
inline std::array<std::uint8_t, 3> ColorToBytes(const Vec3f &color, float scale, float brightness,
                                                const ToneOptions &tone) {
    return ToneMapper(scale, brightness, tone).Bytes(color);
}

/// The settings of ToneMapper as text for engines, such as "gamma 1.4 scale 0.5": pairs of a word and a number, without
/// those that change nothing. Words: contrast (a factor), gamma, exposure, saturation, scale (FactorOf, not the scale
/// of ToneMapper), maxlight, srgb. Engines read it with shgrid_parse_tone.
std::string ToneText(const ToneOptions &tone, float brightness);

} // namespace q3
