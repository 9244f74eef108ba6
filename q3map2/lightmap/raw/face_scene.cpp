// GPL-2.0-or-later. Drawn surfaces as triangles in an Embree scene, for rays that ask what they meet first.
#include "q3map2/lightmap/raw/face_scene.h"

#include <algorithm>

namespace q3 {

int FaceTriangle::NearestVertex(float u, float v) const {
    const std::array<float, 3> weights = Weights(u, v);
    return corners[std::size_t(std::max_element(weights.begin(), weights.end()) - weights.begin())].vertex;
}

void FaceScene::Add(int surface, const Face &face) {
    Vec3f front;
    for (const FaceCorner &corner : face)
        front += corner.normal;
    for (std::size_t i = 2; i < face.size(); ++i) {
        const FaceCorner &a = face[0], &b = face[i - 1], &c = face[i];
        const Vec3f normal = Cross(c.xyz - a.xyz, b.xyz - a.xyz);
        triangles_.push_back({surface, {a, b, c}, Dot(normal, front) < 0 ? -normal : normal});
    }
}

void FaceScene::Commit() {
    const RTCDevice device = SharedDevice();
    scene_ = NewScene(device);
    if (triangles_.empty())
        return CommitScene(device, scene_.get());
    std::vector<float> corners;
    corners.reserve(9 * triangles_.size());
    for (const FaceTriangle &triangle : triangles_)
        for (const FaceCorner &corner : triangle.corners)
            corners.insert(corners.end(), {corner.xyz.x, corner.xyz.y, corner.xyz.z});
    const GeometryPtr geometry = NewTriangles(device, corners);
    rtcAttachGeometry(scene_.get(), geometry.get());
    CommitScene(device, scene_.get());
}

FaceScene::Hits FaceScene::FirstHits(const RayPacket &rays, RayCoherence coherence) const {
    alignas(64) RTCRayHit16 found;
    FindNearest(scene_.get(), rays, 0, found, coherence);
    Hits hits;
    for (std::size_t i = 0; i < kPacketSize; ++i)
        if (rays.live[i] != 0 && found.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID) {
            hits.triangle[i] = &triangles_[found.hit.primID[i]];
            hits.u[i] = found.hit.u[i], hits.v[i] = found.hit.v[i];
        }
    return hits;
}

void FaceScene::TraceOccluded(RayPacket &rays) const {
    alignas(64) RTCRay16 shadow;
    SetRays(rays.origin, rays.direction, rays.distance, rays.live, 0, shadow);
    EmbreeContext context;
    InitContext(context);
    Occluded16(rays.live.data(), scene_.get(), context, shadow);
    for (const std::size_t i : kEachLane)
        rays.live[i] &= shadow.tfar[i] < 0 ? 0 : -1;
}

} // namespace q3
