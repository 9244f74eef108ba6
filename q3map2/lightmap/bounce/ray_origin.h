// GPL-2.0-or-later. Origins of the rays of luxels, and the tangent frame of their directions.
#pragma once

#include "q3map2/lightmap/bounce/bounce_scene.h"

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

/// Ray origins of a lightmap's mapped luxels, by luxel of the super grid: the luxel's position if it is clear, else a
/// clear place at most half a luxel aside. A place is clear if no solid touches it and few rays from it hit the backs
/// of surfaces. The position of a luxel at the edge of a wall may lie in the plane of the adjacent wall, or behind a
/// curve, though a part of the luxel can be seen.
std::vector<Vec3f> RayOrigins(const BspSpace &space, const BounceScene &scene, const RawLightmap &raw);

} // namespace q3
