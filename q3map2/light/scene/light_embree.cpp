// GPL-2.0-or-later. Scenes of triangles in Embree.
#include "q3map2/light/scene/light_embree.h"

#include "common/error.h"

#include <cstdlib>
#include <string>

namespace q3 {

DevicePtr NewDevice() {
    const char *more = std::getenv("Q3MAP2_EMBREE");
    const std::string settings = std::string("threads=1") + (more ? "," : "") + (more ? more : "");
    DevicePtr device(rtcNewDevice(settings.c_str()));
    if (!device)
        throw Error("Embree: cannot create a device");
    return device;
}

ScenePtr NewScene(RTCDevice device) {
    ScenePtr scene(rtcNewScene(device));
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
    return scene;
}

GeometryPtr NewTriangles(RTCDevice device, std::span<const float> corners) {
    GeometryPtr geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
    const std::size_t vertices = corners.size() / 3;
    auto *positions = static_cast<float *>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0,
                                                                   RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices));
    auto *indices = static_cast<unsigned *>(rtcSetNewGeometryBuffer(
        geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), vertices / 3));
    if (!positions || !indices)
        throw Error("out of memory for {} triangles", vertices / 3);
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
