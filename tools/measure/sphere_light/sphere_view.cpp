// GPL-2.0-or-later. The sphere as the camera of the engine sees it.
#include "tools/measure/sphere_light/sphere_view.h"

#include <cmath>
#include <numbers>

namespace q3 {

namespace {

constexpr float kLeastFacing = 0.15f; ///< cosine between the normal and the ray to the eye

} // namespace

Vec3f SpherePlace::Forward() const {
    const float angle = yaw * std::numbers::pi_v<float> / 180;
    return {std::cos(angle), std::sin(angle), 0};
}

std::optional<Vec3f> SphereNormal(const SpherePlace &place, const Image &image, int column, int row) {
    const Vec3f forward = place.Forward(), right{forward.y, -forward.x, 0}, up{0, 0, 1};
    const float half = float(image.width) / 2; // pixels; also the distance of the image plane
    const float x = float(column) + 0.5f - half, y = float(image.height) / 2 - float(row) - 0.5f;
    const Vec3f ray = Normalize(forward * half + right * x + up * y);
    const Vec3f toCenter = forward * kSphereDistance;
    const float along = Dot(ray, toCenter);
    const float discriminant = along * along - Dot(toCenter, toCenter) + kSphereRadius * kSphereRadius;
    if (discriminant <= 0)
        return std::nullopt;
    const Vec3f normal = (ray * (along - std::sqrt(discriminant)) - toCenter) / kSphereRadius;
    if (-Dot(normal, ray) < kLeastFacing)
        return std::nullopt;
    return normal;
}

Vec3f PixelColor(const Image &image, int column, int row) {
    const auto texel = image.Texel(column, row);
    return {float(texel[0]), float(texel[1]), float(texel[2])};
}

} // namespace q3
