// GPL-2.0-or-later. From where the rays of luxels start, and the frame of their directions.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Tangent frame of a receiver.
struct GatherFrame {
    explicit GatherFrame(const Vec3f &n) : normal(n) {
        const Vec3f axis = std::abs(n.z) > 0.7f ? Vec3f{1, 0, 0} : Vec3f{0, 0, 1};
        right = Normalize(Cross(axis, n));
        up = Cross(n, right);
    }
    Vec3f World(const Vec3f &d) const { return right * d.x + up * d.y + normal * d.z; }
    Vec3f Local(const Vec3f &d) const { return {Dot(right, d), Dot(up, d), Dot(normal, d)}; }
    Vec3f normal, right, up;
};

/// Origin of the rays of a luxel: its position, or half a luxel aside if only that is clear of solids. Luxels at the
/// edge of a wall lie in the plane of the adjacent wall, and their rays would start behind it.
Vec3f ClearOrigin(const BspSpace &space, const RawLightmap &raw, std::size_t luxel, const GatherFrame &frame);

} // namespace q3
