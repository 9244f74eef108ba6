// GPL-2.0-or-later. Float light to stored bytes.
#include "q3map2/light/light_tone.h"

#include <algorithm>
#include <cmath>

namespace q3 {

std::array<std::uint8_t, 3> ColorToBytes(const Vec3f &color, float scale, float brightness, const ToneOptions &tone) {
    const auto each = [](Vec3f &v, auto f) { v = {f(v.x), f(v.y), f(v.z)}; };
    Vec3f v = color * (scale > 0 ? scale : 1);
    if (tone.contrast != 1)
        each(v, [&](float c) { return tone.contrast * (c - 128) + 128; });
    each(v, [](float c) { return std::max(c, 0.0f); });
    if (tone.gamma != 1)
        each(v, [&](float c) { return 255 * std::pow(c / 255, 1 / tone.gamma); });
    if (const float m = MaxComponent(v); tone.exposure != 0 && m > 0)
        v *= (1 - std::exp(-m / tone.exposure)) * 255 / m;
    if (tone.saturation != 1) {
        const float grey = 0.3086f * v.x + 0.6094f * v.y + 0.0820f * v.z;
        each(v, [&](float c) { return std::max(grey * (1 - tone.saturation) + c * tone.saturation, 0.0f); });
    }
    v *= (brightness > 0 ? brightness : 1) / tone.compensate;
    if (const float m = MaxComponent(v); m > tone.maxLight)
        v *= tone.maxLight / m;
    if (tone.sRgb)
        each(v, [](float c) { return std::floor(255 * SrgbFromLinear(c / 255) + 0.5f); });
    const auto byte = [](float c) { return std::uint8_t(c >= 255 ? 255 : c > 0 ? int(c) : 0); };
    return {byte(v.x), byte(v.y), byte(v.z)};
}

} // namespace q3
