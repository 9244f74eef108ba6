// GPL-2.0-or-later. Many faint lights represented by a few of them.
#include "q3map2/light/transfer/faint_lights.h"

#include "q3map2/light/sources/falloff.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

bool SelectFaintLight(float faint, float bound, float &residual, float &weight) {
    const float light = bound * weight;
    if (light >= faint)
        return true;
    residual += light;
    if (residual < faint)
        return false;
    residual -= faint;
    weight = faint / bound;
    return true;
}

float LightBound(const Light &light, const Boundsf &box) {
    const float color = MaxComponent(Max(light.color, -light.color));
    if (light.type == LightType::Sun)
        return color * light.photons;
    if (light.type != LightType::Area)
        return color * std::max(0.0f, Falloff(light).At(box.Distance(light.origin)));
    const AreaShape &shape = light.shape;
    const float d = box.Distance(shape.center) - shape.radius;
    const Vec3f n(shape.normal), half = (box.maxs - box.mins) * 0.5f;
    const float reach = std::abs(n.x) * half.x + std::abs(n.y) * half.y + std::abs(n.z) * half.z;
    const float height = std::abs(Dot(n, box.Center()) - float(shape.dist)) + reach;
    const float share = d > 0 ? shape.area * std::min(1.0f, height / d) / (std::numbers::pi_v<float> * d * d) : 1;
    return color * light.add * std::min(1.0f, share);
}

} // namespace q3
