// GPL-2.0-or-later. Affine transforms of placed models.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/entities.h"

#include <array>

namespace q3 {

/// point' = linear . point + origin.
struct ModelTransform {
    std::array<Vec3d, 3> rows{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
    Vec3d origin;

    Vec3d Point(const Vec3d &p) const;
    /// Transforms a normal by the inverse transpose, to unit length. Returns `n` if the transform makes it zero.
    Vec3d Normal(const Vec3d &n) const;
    double Determinant() const;
};
/// Scales, rotates by roll, then pitch, then yaw (degrees), and adds the origin.
ModelTransform MakeModelTransform(const Vec3d &scale, const Vec3d &pitchYawRoll, const Vec3d &origin);
/// Scale of an entity's model along its axes: the key "modelscale_vec", else "modelscale".
Vec3d ModelScaleOf(const Entity &entity);
/// Pitch, yaw and roll of an entity in degrees: the key "angles", else "angle" as yaw.
Vec3d AnglesOf(const Entity &entity);

} // namespace q3
