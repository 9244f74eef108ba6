// GPL-2.0-or-later. The scene of surfaces that reflect paths of bounced light.
#include "tools/measure/bounce_error/path_scene.h"

#include "q3map2/light/scene/light_embree.h"
#include "q3map2/lightmap/bounce/bounce_scene.h"
#include "q3map2/shader/image_formats.h"

#include <algorithm>
#include <cmath>

namespace q3::bounce {

namespace {

int WrappedTexel(float t, int size) {
    const float part = t - std::floor(t);
    return std::isfinite(part) ? std::clamp(int(part * float(size)), 0, size - 1) : 0;
}

struct Triangle {
    int surface = 0;
    std::array<FaceCorner, 3> corners;
    Vec3f normal; // unit, on the front
};

} // namespace

struct PathScene::State {
    State(const SurfaceInputs &inputs, const SurfaceLight &light) : in(inputs), surfaces(light) {}

    void AddSurface(std::size_t number);
    void Commit();
    void Trace(const RayPacket &rays, RTCRayHit16 &found) const;
    Vec3f Color(const Vec3f &bytes) const;
    PathHit HitOf(const Triangle &triangle, float u, float v, bool behind) const;

    const SurfaceInputs &in;
    const SurfaceLight &surfaces;
    std::vector<Triangle> triangles;
    DevicePtr device;
    ScenePtr scene;
};

void PathScene::State::AddSurface(std::size_t number) {
    if (!IsInBounceScene(in, number))
        return;
    for (const Face &face : FacesOf(in, surfaces, number)) {
        Vec3f front;
        for (const FaceCorner &corner : face)
            front += corner.normal;
        for (std::size_t i = 2; i < face.size(); ++i) {
            const FaceCorner &a = face[0], &b = face[i - 1], &c = face[i];
            const Vec3f normal = Normalize(Cross(c.xyz - a.xyz, b.xyz - a.xyz));
            if (normal != Vec3f{})
                triangles.push_back({int(number), {a, b, c}, Dot(normal, front) < 0 ? -normal : normal});
        }
    }
}

void PathScene::State::Commit() {
    device = NewDevice();
    scene = NewScene(device.get());
    if (triangles.empty())
        return rtcCommitScene(scene.get());
    std::vector<float> corners;
    for (const Triangle &triangle : triangles)
        for (const FaceCorner &corner : triangle.corners)
            corners.insert(corners.end(), {corner.xyz.x, corner.xyz.y, corner.xyz.z});
    const GeometryPtr geometry = NewTriangles(device.get(), corners);
    rtcAttachGeometry(scene.get(), geometry.get());
    rtcCommitScene(scene.get());
}

Vec3f PathScene::State::Color(const Vec3f &bytes) const {
    Vec3f c = bytes / 255;
    if (in.lightmap.sRgbTexture || in.lightmap.linearReflectance)
        c = {LinearFromSrgb(c.x), LinearFromSrgb(c.y), LinearFromSrgb(c.z)};
    const float gray = (c.x + c.y + c.z) / 3, ratio = in.lightmap.bounceColorRatio;
    return c * ratio + Vec3f{gray, gray, gray} * (1 - ratio);
}

PathHit PathScene::State::HitOf(const Triangle &triangle, float u, float v, bool behind) const {
    const std::array<float, 3> weights{1 - u - v, u, v};
    PathHit hit;
    hit.surface = triangle.surface;
    hit.behind = behind;
    hit.facingNormal = behind ? -triangle.normal : triangle.normal;
    for (std::size_t k = 0; k < 3; ++k) {
        const FaceCorner &corner = triangle.corners[k];
        hit.position += corner.xyz * weights[k];
        hit.normal += corner.normal * weights[k];
        for (std::size_t axis = 0; axis < 2; ++axis)
            hit.luxel[axis] += corner.luxel[axis] * weights[k], hit.st[axis] += corner.st[axis] * weights[k];
    }
    hit.normal = Normalize(hit.normal);
    if (Dot(hit.normal, triangle.normal) <= 0)
        hit.normal = triangle.normal;
    const auto nearest = std::max_element(weights.begin(), weights.end()) - weights.begin();
    hit.vertex = triangle.corners[std::size_t(nearest)].vertex;
    return hit;
}

PathScene::PathScene(const SurfaceInputs &in, const SurfaceLight &surfaces)
    : state_(std::make_unique<State>(in, surfaces)) {
    for (std::size_t i = 0; i < in.bsp.drawSurfaces.size(); ++i)
        state_->AddSurface(i);
    state_->Commit();
}

PathScene::~PathScene() = default;

void PathScene::State::Trace(const RayPacket &rays, RTCRayHit16 &found) const {
    SetRays(rays.origin, rays.direction, rays.distance, rays.live, 0, found.ray);
    std::fill(std::begin(found.hit.geomID), std::end(found.hit.geomID), RTC_INVALID_GEOMETRY_ID);
    EmbreeContext context;
    InitContext(context);
    Intersect16(rays.live.data(), scene.get(), context, found, false);
}

void PathScene::FirstHits(const RayPacket &rays, Hits &hits, LaneMask *met) const {
    alignas(64) RTCRayHit16 found;
    state_->Trace(rays, found);
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        hits[i].reset();
        const bool meets = rays.live[i] != 0 && found.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
        if (met)
            (*met)[i] = meets ? -1 : 0;
        if (!meets)
            continue;
        const Triangle &triangle = state_->triangles[found.hit.primID[i]];
        const auto surface = std::size_t(triangle.surface);
        const ShaderInfo &shader = *state_->in.table[surface].shader;
        const bool behind = Dot(triangle.normal, rays.direction[i]) >= 0;
        if ((behind && !shader.twoSided) || !(shader.bounceScale > 0))
            continue;
        hits[i] = state_->HitOf(triangle, found.hit.u[i], found.hit.v[i], behind);
        hits[i]->reflectance = ReflectanceAt(surface, hits[i]->st);
    }
}

int PathScene::CountBackHits(const RayPacket &rays) const {
    alignas(64) RTCRayHit16 found;
    state_->Trace(rays, found);
    int backs = 0;
    for (std::size_t i = 0; i < kPacketSize; ++i)
        if (rays.live[i] != 0 && found.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID) {
            const Triangle &triangle = state_->triangles[found.hit.primID[i]];
            backs += !state_->in.table[std::size_t(triangle.surface)].shader->twoSided &&
                     Dot(triangle.normal, rays.direction[i]) >= 0;
        }
    return backs;
}

Vec3f PathScene::ReflectanceAt(std::size_t surface, const std::array<float, 2> &st) const {
    const ShaderInfo &shader = *state_->in.table[surface].shader;
    Vec3f bytes = shader.averageColor;
    if (shader.imageFound && shader.lightImage) {
        const Image &image = *shader.lightImage;
        const auto texel = image.Texel(WrappedTexel(st[0], image.width), WrappedTexel(st[1], image.height));
        bytes = {float(texel[0]), float(texel[1]), float(texel[2])};
    }
    const Vec3f reflectance = state_->Color(bytes) * BounceScale(state_->in, surface);
    return Min(reflectance, Vec3f{kMaxReflectance, kMaxReflectance, kMaxReflectance});
}

Vec3f PathScene::MeanReflectanceAt(std::size_t surface, const std::array<float, 2> &st, int side) const {
    const ShaderInfo &shader = *state_->in.table[surface].shader;
    if (!shader.imageFound || !shader.lightImage)
        return ReflectanceAt(surface, st);
    const Image &image = *shader.lightImage;
    const int width = std::min(side, image.width), height = std::min(side, image.height);
    const int x = WrappedTexel(st[0], width), y = WrappedTexel(st[1], height);
    Vec3f sum;
    int count = 0;
    for (int row = y * image.height / height; row < (y + 1) * image.height / height; ++row)
        for (int column = x * image.width / width; column < (x + 1) * image.width / width; ++column, ++count) {
            const auto texel = image.Texel(column, row);
            sum += state_->Color({float(texel[0]), float(texel[1]), float(texel[2])});
        }
    return sum * (BounceScale(state_->in, surface) / float(std::max(1, count)));
}

} // namespace q3::bounce
