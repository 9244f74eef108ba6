// GPL-2.0-or-later. The sphere as the camera of the engine sees it.
#pragma once

#include "common/image/image.h"
#include "libs/math/vec.h"

#include <optional>

namespace q3 {

// Game units: how far the command testmodel puts the model from the eye; the radius that sphere_md3.py gives it.
inline constexpr float kSphereDistance = 100, kSphereRadius = 16;

/// A place of the sphere, and the heading of the camera: degrees, 0 is +x, 90 is +y.
struct SpherePlace {
    Vec3f center;
    float yaw = 0;

    Vec3f Forward() const;
    Vec3f Eye() const { return center - Forward() * kSphereDistance; }
};

/// Normal of the sphere at the center of a pixel, for a horizontal field of view of 90 degrees. Empty outside the
/// sphere, and within a few pixels of its outline, where the triangles of the model deviate from it.
std::optional<Vec3f> SphereNormal(const SpherePlace &place, const Image &image, int column, int row);

/// Color of a pixel, byte scale.
Vec3f PixelColor(const Image &image, int column, int row);

} // namespace q3
