// GPL-2.0-or-later. Rays that are traced together.
#pragma once

#include "q3map2/light/batch/lanes.h"

#include <cstdint>
#include <span>

namespace q3 {

/// One packet of rays, a ray per lane: from neighboring receivers toward one light, or from one receiver toward one
/// area light. Values in lanes that are not live are undefined.
struct RayPacket {
    Lanes3 origin, direction; ///< unit directions
    Lanes distance;           ///< length of the ray, to the light. Game units
    LaneMask live{};          ///< in: rays to trace; out: rays whose light arrives
    LaneMask filtered{};      ///< out: rays that met a see-through surface; valid if tinted, or after TraceSurfaceTo*
    bool tinted = false;      ///< out: some live ray went through a see-through surface
    Lanes3 tint;              ///< out, if tinted: transmittance per channel along the live rays
    int ignoredProp = -1;     ///< in: static prop that does not block rays to lights; -1: none

    /// Sets ray i and makes it live.
    void Set(std::size_t i, const Vec3f &from, const Vec3f &along, float length) {
        origin.Set(i, from);
        direction.Set(i, along);
        distance[i] = length;
        live[i] = -1;
    }
    /// Sets ray i from one point to another; direction +z if they coincide.
    void Aim(std::size_t i, const Vec3f &from, const Vec3f &target) {
        const Vec3f way = target - from;
        const float length = Length(way);
        Set(i, from, length > 0 ? way / length : Vec3f{0, 0, 1}, length);
    }
};

/// Rays cast so far, for statistics; one per worker.
struct RayCounts {
    std::uint64_t rays = 0;
};
inline std::uint64_t TotalRays(std::span<const RayCounts> workers) {
    std::uint64_t rays = 0;
    for (const RayCounts &one : workers)
        rays += one.rays;
    return rays;
}

} // namespace q3
