// GPL-2.0-or-later. One interface to Embree 3.13 and 4: packets of 16 rays, owning handles.
#pragma once

#if Q3_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "q3map2/light/batch/lanes.h"
#include "q3map2/light/batch/receivers.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <numeric>
#include <span>
#include <type_traits>

namespace q3 {

struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct ReleaseGeometry {
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using ScenePtr = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;
using GeometryPtr = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, ReleaseGeometry>;

#if Q3_EMBREE_MAJOR >= 4
using EmbreeContext = RTCRayQueryContext;
inline void InitContext(EmbreeContext &context) {
    rtcInitRayQueryContext(&context);
}
inline void Intersect16(const int *valid, RTCScene scene, EmbreeContext &context, RTCRayHit16 &rays,
                        RayCoherence coherence) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = coherence == RayCoherence::Coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    arguments.context = &context;
    rtcIntersect16(valid, scene, &rays, &arguments);
}
inline void Occluded16(const int *valid, RTCScene scene, EmbreeContext &context, RTCRay16 &rays) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    arguments.context = &context;
    rtcOccluded16(valid, scene, &rays, &arguments);
}
#else
using EmbreeContext = RTCIntersectContext;
inline void InitContext(EmbreeContext &context) {
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
}
inline void Intersect16(const int *valid, RTCScene scene, EmbreeContext &context, RTCRayHit16 &rays,
                        RayCoherence coherence) {
    context.flags = coherence == RayCoherence::Coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                                        : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect16(valid, scene, &context, &rays);
}
inline void Occluded16(const int *valid, RTCScene scene, EmbreeContext &context, RTCRay16 &rays) {
    rtcOccluded16(valid, scene, &context, &rays);
}
#endif

/// The device of all scenes, made on first use. It lives until the process ends, since Embree allocates memory and
/// starts a thread when a device is released, and ends the process where it cannot. The environment variable
/// Q3MAP2_EMBREE adds settings, see rtcNewDevice: "isa=avx2" imitates an older processor; each value has its own
/// device. Errors: Error or std::bad_alloc.
RTCDevice SharedDevice();
/// An empty scene, watertight and built for fast tracing. Errors: Error or std::bad_alloc.
ScenePtr NewScene(RTCDevice device);
/// Builds a scene of the device. Errors: of this thread's earlier calls too, std::bad_alloc or Error.
void CommitScene(RTCDevice device, RTCScene scene);
/// Triangles of three corners each, xyz one after the other, committed. Errors: Error or std::bad_alloc.
GeometryPtr NewTriangles(RTCDevice device, std::span<const float> corners);

/// Sets `rays` to the live rays, from `nearest` to `distance` along unit directions. Lanes that are not live may hold
/// anything and get rays that end before they start: Embree reads them too on processors without 16-wide vectors.
/// nearest: a float, or Lanes with one per ray.
template <typename Nearest>
inline void SetRays(const Lanes3 &origin, const Lanes3 &direction, const Lanes &distance, const LaneMask &live,
                    const Nearest &nearest, RTCRay16 &rays) {
    const auto row = [&](const Lanes &from, float none, float *to) {
        for (const std::size_t i : kEachLane)
            to[i] = live[i] != 0 ? from[i] : none;
    };
    row(origin.x, 0, rays.org_x), row(origin.y, 0, rays.org_y), row(origin.z, 0, rays.org_z);
    row(direction.x, 0, rays.dir_x), row(direction.y, 0, rays.dir_y), row(direction.z, 1, rays.dir_z);
    row(distance, -1, rays.tfar);
    if constexpr (std::is_same_v<Nearest, Lanes>)
        std::copy(nearest.begin(), nearest.end(), rays.tnear);
    else
        std::fill(std::begin(rays.tnear), std::end(rays.tnear), float(nearest));
    std::fill(std::begin(rays.time), std::end(rays.time), 0.0f);
    std::fill(std::begin(rays.mask), std::end(rays.mask), ~0u);
    std::fill(std::begin(rays.flags), std::end(rays.flags), 0u);
    std::iota(std::begin(rays.id), std::end(rays.id), 0u);
}

/// Nearest hit of every live ray beyond its `nearest`; hit.geomID is RTC_INVALID_GEOMETRY_ID for rays that miss.
void FindNearest(RTCScene scene, const RayPacket &packet, const Lanes &nearest, RTCRayHit16 &hits,
                 RayCoherence coherence = RayCoherence::Coherent);
void FindNearest(RTCScene scene, const RayPacket &packet, float nearest, RTCRayHit16 &hits,
                 RayCoherence coherence = RayCoherence::Coherent);

} // namespace q3
