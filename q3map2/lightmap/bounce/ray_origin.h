// GPL-2.0-or-later. From where the rays of luxels start, and the frame of their directions.
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

/// Origins of the rays of a lightmap's mapped luxels, by luxel of the super grid: the position, or a place at most half
/// a luxel aside if only that is clear. Clear is what no solid touches and what sees few backs of surfaces. A luxel at
/// the edge of a wall lies in the plane of the adjacent wall, or behind a curve, though a part of it can be seen.
std::vector<Vec3f> RayOrigins(const BspSpace &space, const BounceScene &scene, const RawLightmap &raw);

} // namespace q3
