// GPL-2.0-or-later. The scene of surfaces that reflect paths of bounced light.
#include "tools/measure/bounce_error/path_scene.h"

#include "q3map2/lightmap/bounce/bounce_scene.h"
#include "q3map2/lightmap/raw/face_scene.h"
#include "q3map2/shader/image_formats.h"

#include <algorithm>
#include <cmath>

namespace q3::bounce {

namespace {

int WrappedTexel(float t, int size) {
    const float part = t - std::floor(t);
    return std::isfinite(part) ? std::clamp(int(part * float(size)), 0, size - 1) : 0;
}

} // namespace

struct PathScene::State {
    State(const SurfaceInputs &inputs, const SurfaceLight &light) : in(inputs), surfaces(light) {}

    void AddSurface(std::size_t number);
    Vec3f Color(const Vec3f &bytes) const;
    PathHit HitOf(const FaceTriangle &triangle, float u, float v, bool behind) const;

    const SurfaceInputs &in;
    const SurfaceLight &surfaces;
    FaceScene faces;
};

void PathScene::State::AddSurface(std::size_t number) {
    if (!IsInBounceScene(in, number))
        return;
    for (const Face &face : FacesOf(in, surfaces, number))
        faces.Add(int(number), face);
}

Vec3f PathScene::State::Color(const Vec3f &bytes) const {
    Vec3f c = bytes / 255;
    if (in.lightmap.sRgbTexture || in.lightmap.linearReflectance)
        c = {LinearFromSrgb(c.x), LinearFromSrgb(c.y), LinearFromSrgb(c.z)};
    const float gray = (c.x + c.y + c.z) / 3, ratio = in.lightmap.bounceColorRatio;
    return c * ratio + Vec3f{gray, gray, gray} * (1 - ratio);
}

PathHit PathScene::State::HitOf(const FaceTriangle &triangle, float u, float v, bool behind) const {
    const Vec3f front = Normalize(triangle.front);
    PathHit hit;
    hit.surface = triangle.surface;
    hit.behind = behind;
    hit.facingNormal = behind ? -front : front;
    hit.position = triangle.PositionAt(u, v);
    hit.luxel = triangle.LuxelAt(u, v);
    hit.st = triangle.TextureAt(u, v);
    hit.normal = Normalize(triangle.NormalAt(u, v));
    if (Dot(hit.normal, front) <= 0)
        hit.normal = front;
    hit.vertex = triangle.NearestVertex(u, v);
    return hit;
}

PathScene::PathScene(const SurfaceInputs &in, const SurfaceLight &surfaces)
    : state_(std::make_unique<State>(in, surfaces)) {
    for (std::size_t i = 0; i < in.bsp.drawSurfaces.size(); ++i)
        state_->AddSurface(i);
    state_->faces.Commit();
}

PathScene::~PathScene() = default;

void PathScene::FirstHits(const RayPacket &rays, Hits &hits, LaneMask *met) const {
    const FaceScene::Hits found = state_->faces.FirstHits(rays, RayCoherence::Incoherent);
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        hits[i].reset();
        const bool meets = found.triangle[i] != nullptr;
        if (met)
            (*met)[i] = meets ? -1 : 0;
        if (!meets)
            continue;
        const FaceTriangle &triangle = *found.triangle[i];
        const auto surface = std::size_t(triangle.surface);
        const ShaderInfo &shader = *state_->in.table[surface].shader;
        const bool behind = !found.InFront(i, rays);
        if ((behind && !shader.twoSided) || !(shader.bounceScale > 0))
            continue;
        hits[i] = state_->HitOf(triangle, found.u[i], found.v[i], behind);
        hits[i]->reflectance = ReflectanceAt(surface, hits[i]->st);
    }
}

int PathScene::CountBackHits(const RayPacket &rays) const {
    const FaceScene::Hits found = state_->faces.FirstHits(rays, RayCoherence::Incoherent);
    int backs = 0;
    for (std::size_t i = 0; i < kPacketSize; ++i)
        if (const FaceTriangle *triangle = found.triangle[i])
            backs += !state_->in.table[std::size_t(triangle->surface)].shader->twoSided && !found.InFront(i, rays);
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
