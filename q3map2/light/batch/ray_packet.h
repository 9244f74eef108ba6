// GPL-2.0-or-later. Rays that are traced together, and single rays gathered to full packets.
#pragma once

#include "q3map2/light/batch/lanes.h"

#include <array>
#include <cstdint>
#include <span>
#include <utility>

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
        const Vec3f offset = target - from;
        const float length = Length(offset);
        Set(i, from, length > 0 ? offset / length : Vec3f{0, 0, 1}, length);
    }
};

/// Hint for Embree: whether the rays of a packet are close to each other and nearly parallel.
enum class RayCoherence { Coherent, Incoherent };

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

/// Queues rays, each with a tag that says whose it is, and calls trace(packet, tags) whenever sixteen have come
/// together and, for the rest, in Flush: ray i of the packet belongs to tags[i]; lanes beyond the tags are not live.
/// `trace` casts the rays and hands the results to their owners; it must not add rays.
template <typename Tag, typename Trace> class RayBatcher {
  public:
    explicit RayBatcher(Trace trace) : trace_(std::move(trace)) {}

    void Add(const Tag &tag, const Vec3f &from, const Vec3f &direction, float distance) {
        packet_.Set(count_, from, direction, distance);
        Queue(tag);
    }
    /// A ray from one point to another.
    void Aim(const Tag &tag, const Vec3f &from, const Vec3f &target) {
        packet_.Aim(count_, from, target);
        Queue(tag);
    }
    /// Traces the rays that wait. Call after the last ray.
    void Flush() {
        if (count_ == 0)
            return;
        for (std::size_t i = count_; i < kPacketSize; ++i)
            packet_.live[i] = 0;
        trace_(packet_, std::span<const Tag>(tags_.data(), count_));
        count_ = 0;
    }

  private:
    void Queue(const Tag &tag) {
        tags_[count_++] = tag;
        if (count_ == kPacketSize)
            Flush();
    }

    Trace trace_;
    RayPacket packet_;
    std::array<Tag, kPacketSize> tags_{};
    std::size_t count_ = 0;
};

/// A RayBatcher for this `trace`.
template <typename Tag, typename Trace> RayBatcher<Tag, Trace> MakeRayBatcher(Trace trace) {
    return RayBatcher<Tag, Trace>(std::move(trace));
}

} // namespace q3
