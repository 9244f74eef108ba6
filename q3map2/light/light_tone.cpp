// GPL-2.0-or-later. Float light to stored bytes.
#include "q3map2/light/light_tone.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

template <typename F> Vec3f Each(const Vec3f &v, const F &f) {
    return {f(v.x), f(v.y), f(v.z)};
}

float NotNegative(float c) {
    return std::max(c, 0.0f);
}

/// NaN gives 0.
std::uint8_t Byte(float c) {
    return std::uint8_t(int(std::min(std::max(0.0f, c), 255.0f)));
}

/// Contrast, gamma, exposure and saturation, which few maps change.
Vec3f Graded(const Vec3f &color, const ToneOptions &tone) {
    Vec3f v = color;
    if (tone.contrast != 1)
        v = Each(v, [&](float c) { return tone.contrast * (c - 128) + 128; });
    v = Each(v, NotNegative);
    if (tone.gamma != 1)
        v = Each(v, [&](float c) { return 255 * std::pow(c / 255, 1 / tone.gamma); });
    if (const float m = MaxComponent(v); tone.exposure != 0 && m > 0)
        v *= (1 - std::exp(-m / tone.exposure)) * 255 / m;
    if (tone.saturation == 1)
        return v;
    const float grey = 0.3086f * v.x + 0.6094f * v.y + 0.0820f * v.z;
    return Each(v, [&](float c) { return NotNegative(grey * (1 - tone.saturation) + c * tone.saturation); });
}

} // namespace

std::array<std::uint8_t, 3> ColorToBytes(const Vec3f &color, float scale, float brightness, const ToneOptions &tone) {
    const Vec3f scaled = color * (scale > 0 ? scale : 1);
    const bool plain = (tone.contrast == 1) & (tone.gamma == 1) & (tone.exposure == 0) & (tone.saturation == 1);
    Vec3f v = plain ? Each(scaled, NotNegative) : Graded(scaled, tone);
    v *= (brightness > 0 ? brightness : 1) / tone.compensate;
    if (const float m = MaxComponent(v); m > tone.maxLight)
        v *= tone.maxLight / m;
    if (tone.sRgb)
        v = Each(v, [](float c) { return std::floor(255 * SrgbFromLinear(c / 255) + 0.5f); });
    return {Byte(v.x), Byte(v.y), Byte(v.z)};
}

} // namespace q3
