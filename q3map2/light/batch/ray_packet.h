// GPL-2.0-or-later. Rays that are traced together.
#pragma once

#include "q3map2/light/batch/lanes.h"

#include <cstdint>

namespace q3 {

/// One packet of rays, a ray per lane: from neighbouring receivers toward one light, or from one receiver toward one
/// area light. Numbers of rays that are not live mean nothing.
struct RayPacket {
    Lanes3 origin, direction; ///< unit directions
    Lanes distance;           ///< where the ray ends: at the light. Game units
    LaneMask live{};          ///< in: rays to trace; out: those whose light arrives
    LaneMask filtered{};      ///< out, rays of surfaces: those that met a see-through surface
    bool tinted = false;      ///< out: some ray went through a coloured surface
    Lanes3 tint;              ///< out, if tinted: transmittance, per channel, of what the live rays went through

    /// Sets ray i, which is live then.
    void Set(std::size_t i, const Vec3f &from, const Vec3f &along, float length) {
        origin.Set(i, from);
        direction.Set(i, along);
        distance[i] = length;
        live[i] = -1;
    }
    /// The same for a ray between two points; along +z if they are one.
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

} // namespace q3
