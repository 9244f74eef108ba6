// GPL-2.0-or-later. Embree 3.13 and 4 under one face: packets of 16 rays; handles that release themselves.
#pragma once

#if Q3_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <memory>
#include <type_traits>

namespace q3 {

struct ReleaseDevice {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct ReleaseGeometry {
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using DevicePtr = std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice>;
using ScenePtr = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;
using GeometryPtr = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, ReleaseGeometry>;

#if Q3_EMBREE_MAJOR >= 4
using EmbreeContext = RTCRayQueryContext;
inline void InitContext(EmbreeContext &context) {
    rtcInitRayQueryContext(&context);
}
inline void Intersect16(const int *valid, RTCScene scene, EmbreeContext &context, RTCRayHit16 &rays) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
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
inline void Intersect16(const int *valid, RTCScene scene, EmbreeContext &context, RTCRayHit16 &rays) {
    rtcIntersect16(valid, scene, &context, &rays);
}
inline void Occluded16(const int *valid, RTCScene scene, EmbreeContext &context, RTCRay16 &rays) {
    rtcOccluded16(valid, scene, &context, &rays);
}
#endif

} // namespace q3
