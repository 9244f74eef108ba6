// GPL-2.0-or-later. Affine transforms of placed models.
#include "q3map2/model/model_transform.h"

#include "q3map2/bspfile/object_keys.h"

#include <cmath>
#include <numbers>

namespace q3 {

namespace {

constexpr double kToRadians = std::numbers::pi / 180;

} // namespace

Vec3d ModelTransform::Point(const Vec3d &p) const {
    return Vec3d{Dot(rows[0], p), Dot(rows[1], p), Dot(rows[2], p)} + origin;
}

double ModelTransform::Determinant() const {
    return Dot(rows[0], Cross(rows[1], rows[2]));
}

Vec3d ModelTransform::Normal(const Vec3d &n) const {
    // The cofactor matrix = determinant * inverse transpose; it exists for singular transforms too.
    const Vec3d turned{Dot(Cross(rows[1], rows[2]), n), Dot(Cross(rows[2], rows[0]), n),
                       Dot(Cross(rows[0], rows[1]), n)};
    const Vec3d unit = Normalize(Determinant() < 0 ? -turned : turned);
    return unit == Vec3d{} ? n : unit;
}

ModelTransform MakeModelTransform(const Vec3d &scale, const Vec3d &pitchYawRoll, const Vec3d &origin) {
    const Vec3d a = pitchYawRoll * kToRadians;
    const double sp = std::sin(a.x), cp = std::cos(a.x), sy = std::sin(a.y), cy = std::cos(a.y);
    const double sr = std::sin(a.z), cr = std::cos(a.z);
    ModelTransform transform;
    transform.rows[0] = Vec3d{cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr} * scale;
    transform.rows[1] = Vec3d{sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr} * scale;
    transform.rows[2] = Vec3d{-sp, cp * sr, cp * cr} * scale;
    transform.origin = origin;
    return transform;
}

Vec3d ModelScaleOf(const Entity &entity) {
    if (const auto scale = keys::kModelScaleVec.Vector(entity))
        return Vec3d(*scale);
    const double scale = keys::kModelScale.Number(entity);
    return scale == 0 ? Vec3d{1, 1, 1} : Vec3d{scale, scale, scale};
}

Vec3d AnglesOf(const Entity &entity) {
    if (const auto angles = keys::kAngles.Vector(entity))
        return Vec3d(*angles);
    return {0, keys::kAngle.Number(entity), 0};
}

} // namespace q3
