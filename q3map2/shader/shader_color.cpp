// GPL-2.0-or-later. Color spaces.
#include "q3map2/shader/shader_color.h"

#include <cmath>

namespace q3 {

float LinearFromSrgb(float c) {
    return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

float SrgbFromLinear(float c) {
    return c <= 0.0031308f ? c * 12.92f : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
}

Vec3f NormalizeColor(const Vec3f &c) {
    const float largest = MaxComponent(c);
    const Vec3f normal = c / largest;
    return largest > 0 && IsFinite(normal) ? normal : Vec3f{1, 1, 1};
}

} // namespace q3
