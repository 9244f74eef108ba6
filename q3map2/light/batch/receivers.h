// GPL-2.0-or-later. What is lit together: neighboring receivers, the light that arrives at them, and packets of their
// rays.
#pragma once

#include "q3map2/light/batch/lanes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

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

/// The clusters that the receivers of a batch are in: few, since the receivers are neighbors.
struct LaneClusters {
    std::size_t count = 0;
    std::array<int, kPacketSize> number{};     ///< of each cluster, without duplicates
    std::array<unsigned, kPacketSize> lanes{}; ///< by cluster: bits of its receivers, as LaneMask::Bits

    void Add(std::size_t lane, int cluster);
};

/// Up to sixteen neighboring receivers: points in the open, of a light grid or between its points.
struct ReceiverBatch {
    std::size_t count = 0;
    Lanes3 position{}, rayOrigin{}; ///< rays start at the position, or slightly beside it to clear solids
    LaneClusters clusters;
    std::array<std::uint32_t, kPacketSize> index{}; ///< of the grid point: seeds its sample patterns
    LaneMask wanted{};       ///< receivers to light; cleared for points and vertices that need no more
    float faintResidual = 0; ///< light of faint sources not yet represented; see SelectFaintLight. Byte scale

    bool Full() const { return count == kPacketSize; }
    /// Adds a receiver, whose light is wanted. Call it only if the batch is not full.
    void Add(const Vec3f &at, const Vec3f &raysFrom, int clusterAt, std::uint32_t indexAt);
};

/// Receivers on surfaces: luxels or vertices. Rays start at the position.
struct SurfaceReceiverBatch : ReceiverBatch {
    Lanes3 normal{};       ///< unit
    bool twoSided = false; ///< light from behind counts too

    void Add(const Vec3f &at, const Vec3f &normalAt, int clusterAt);
};

/// The last batch; appends a new one first if the last is full or missing.
template <typename Batch> Batch &BatchWithRoom(std::vector<Batch> &batches) {
    if (batches.empty() || batches.back().Full())
        batches.emplace_back();
    return batches.back();
}

/// Number of batches that `count` receivers fill.
inline std::size_t BatchCount(std::size_t count) {
    return (count + kPacketSize - 1) / kPacketSize;
}

/// The part of `all` that is batch number `batch`, in order.
template <typename T> std::span<T> BatchOf(std::span<T> all, std::size_t batch) {
    const std::size_t first = batch * kPacketSize;
    return all.subspan(first, std::min(kPacketSize, all.size() - first));
}

/// Light of one source at each receiver: the light's color times `strength` times `tint`.
struct IncidentLight {
    LaneMask live{};     ///< receivers that get light; values in other lanes are undefined
    Lanes strength;      ///< light for color 1 1 1, byte scale, > 0
    Lanes3 direction;    ///< unit, to the light; zero at the light's own position
    Lanes distance;      ///< length of the shadow ray. Game units
    bool tinted = false; ///< some live ray went through a see-through surface
    Lanes3 tint;         ///< transmittance per channel, if tinted
};

/// IncidentLight with its SH projection, for light grids.
struct ProbeIncidentLight : IncidentLight {
    /// SH grid only: the incident radiance projected on the nine basis functions (sh.h), cosine-convolved unless
    /// LightSettings::radiance, before the tint; byte scale, for a light of color 1 1 1. Zero where nothing arrives.
    std::array<Lanes, 9> shCoeffs;
    /// SH grid only: the light's strength on a surface that faces it without shadows (of area lights an estimate), and
    /// the fraction of it that arrives. 0 where the light does not reach, or has not the part that is traced.
    Lanes unshadowed, visible;
};

/// The directions that light comes from. A receiver in the same place with normal b gets
/// strength * (max(0, vector . b) + uniform), which is `strength` for its own normal.
struct LightDirections {
    Lanes3 vector; ///< irradiance vector divided by `strength`
    Lanes uniform; ///< fraction of `strength` that every normal gets
    Lanes spread;  ///< fluence divided by the length of the irradiance vector: 1 for a point, 2 for a hemisphere
};

/// IncidentLight on surfaces.
struct SurfaceIncidentLight : IncidentLight {
    LaneMask undirected{};      ///< lit from behind: adds nothing to deluxe maps
    LaneMask filtered{};        ///< the ray went through a see-through surface, or ended at one
    LightDirections directions; ///< of live receivers, if SurfaceLightSettings::directional
};

} // namespace q3
