// GPL-2.0-or-later. Float light to stored bytes.
#include "q3map2/light/options/light_tone.h"
#include "libs/math/elementary.h"
#include "q3map2/shader/image_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace q3 {

namespace {

template <typename F> Vec3f Each(const Vec3f &v, const F &f) {
    return {f(v.x), f(v.y), f(v.z)};
}

float NotNegative(float c) {
    return std::max(c, 0.0f);
}

/// Luminance of linear RGB by Haeberli, Matrix Operations for Image Processing, 1993.
float GrayOf(const Vec3f &v) {
    return 0.3086f * v.x + 0.6094f * v.y + 0.0820f * v.z;
}

/// Exposure maps all light to less than full; LightOf takes full light as this much below it.
constexpr float kLeastShare = 1.0f / 512;

} // namespace

Vec3f ToneMapper::Graded(const Vec3f &color) const {
    Vec3f v = color;
    if (tone_.contrast != 1)
        v = Each(v, [&](float c) { return tone_.contrast * (c - 128) + 128; });
    v = Each(v, NotNegative);
    if (tone_.gamma != 1)
        v = Each(v, [&](float c) { return 255 * Pow(c / 255, 1 / tone_.gamma); });
    if (const float m = MaxComponent(v); tone_.exposure != 0 && m > 0)
        v *= (1 - Exp(-m / tone_.exposure)) * 255 / m;
    if (tone_.saturation == 1)
        return v;
    const float gray = GrayOf(v);
    return Each(v, [&](float c) { return NotNegative(gray * (1 - tone_.saturation) + c * tone_.saturation); });
}

Vec3f ToneMapper::LightOf(const Vec3f &bytes) const {
    Vec3f v = bytes;
    if (tone_.sRgb)
        v = Each(v, [](float c) { return 255 * LinearFromSrgb(c / 255); });
    v *= 1 / factor_;
    if (tone_.saturation != 1) { // the gray of a color stays, up to the rounding of its weights
        const float gray = GrayOf(v);
        v = Each(v, [&](float c) { return (c - gray * (1 - tone_.saturation)) / tone_.saturation; });
    }
    if (const float m = MaxComponent(v); tone_.exposure != 0 && m > 0)
        v *= -tone_.exposure * std::log(std::max(kLeastShare, 1 - m / 255)) / m;
    if (tone_.gamma != 1)
        v = Each(v, [&](float c) { return 255 * Pow(NotNegative(c) / 255, tone_.gamma); });
    if (tone_.contrast != 1)
        v = Each(v, [&](float c) { return (c - 128) / tone_.contrast + 128; });
    return v * (1 / scale_);
}

Vec3f ToneMapper::InSrgb(const Vec3f &color) {
    return Each(color, [](float c) { return std::floor(255 * SrgbFromLinear(c / 255) + 0.5f); });
}

std::string ToneText(const ToneOptions &tone, float brightness) {
    std::string text;
    const auto add = [&text](std::string_view word, float value, float plain) {
        if (value != plain)
            text += fmt::format("{}{} {}", text.empty() ? "" : " ", word, value);
    };
    add("contrast", tone.contrast, 1);
    add("gamma", tone.gamma, 1);
    add("exposure", tone.exposure, 0);
    add("saturation", tone.saturation, 1);
    add("scale", ToneMapper::FactorOf(brightness, tone), 1);
    add("maxlight", tone.maxLight, 255);
    add("srgb", tone.sRgb ? 1 : 0, 0);
    return text;
}

} // namespace q3
