// GPL-2.0-or-later. Scenes of triangles in Embree.
#include "q3map2/light/scene/light_embree.h"

#include "common/error.h"

#include <cstdlib>
#include <map>
#include <mutex>
#include <new>
#include <string>

namespace q3 {

namespace {

/// device: null asks about the creation of a device.
void RequireSuccess(RTCDevice device) {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_OUT_OF_MEMORY)
        throw std::bad_alloc();
    if (error != RTC_ERROR_NONE || !device)
        throw Error("Embree: {}", device ? "a scene cannot be built" : "a device cannot be made");
}

} // namespace

RTCDevice SharedDevice() {
    static std::mutex making;
    static std::map<std::string, RTCDevice> devices; // by settings
    const char *more = std::getenv("Q3MAP2_EMBREE");
    const std::lock_guard lock(making);
    const std::string settings = std::string("threads=1") + (more ? "," : "") + (more ? more : "");
    RTCDevice &device = devices[settings];
    if (!device) {
        device = rtcNewDevice(settings.c_str());
        if (!device)
            RequireSuccess(nullptr);
    }
    return device;
}

ScenePtr NewScene(RTCDevice device) {
    ScenePtr scene(rtcNewScene(device));
    RequireSuccess(device);
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
    return scene;
}

void CommitScene(RTCDevice device, RTCScene scene) {
    RequireSuccess(device); // without memory for a geometry, building the scene would end the process
    rtcCommitScene(scene);
    RequireSuccess(device);
}

GeometryPtr NewTriangles(RTCDevice device, std::span<const float> corners) {
    GeometryPtr geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
    const std::size_t vertices = corners.size() / 3;
    auto *positions = static_cast<float *>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0,
                                                                   RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices));
    auto *indices = static_cast<unsigned *>(rtcSetNewGeometryBuffer(
        geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), vertices / 3));
    RequireSuccess(device);
    if (!positions || !indices)
        throw std::bad_alloc();
    std::copy(corners.begin(), corners.end(), positions);
    std::iota(indices, indices + vertices, 0u);
    rtcCommitGeometry(geometry.get());
    return geometry;
}

void FindNearest(RTCScene scene, const RayPacket &packet, const Lanes &nearest, RTCRayHit16 &hits,
                 RayCoherence coherence) {
    Vectorize([&, scene, coherence]() Q3_INLINE {
        SetRays(packet.origin, packet.direction, packet.distance, packet.live, nearest, hits.ray);
        std::fill(std::begin(hits.hit.geomID), std::end(hits.hit.geomID), RTC_INVALID_GEOMETRY_ID);
        EmbreeContext context;
        InitContext(context);
        Intersect16(packet.live.data(), scene, context, hits, coherence);
    });
}

void FindNearest(RTCScene scene, const RayPacket &packet, float nearest, RTCRayHit16 &hits, RayCoherence coherence) {
    Lanes nearestOfLanes;
    nearestOfLanes.fill(nearest);
    FindNearest(scene, packet, nearestOfLanes, hits, coherence);
}

} // namespace q3
