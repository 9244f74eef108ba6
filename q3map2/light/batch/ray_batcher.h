// GPL-2.0-or-later. Single rays, traced in full packets.
#pragma once

#include "q3map2/light/batch/ray_packet.h"

#include <array>
#include <span>
#include <utility>

namespace q3 {

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
