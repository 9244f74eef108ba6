// GPL-2.0-or-later. The surfaces that reflect bounced light, as a scene for gather rays.
#include "q3map2/lightmap/bounce/bounce_scene.h"

#include "common/error.h"
#include "q3map2/light/batch/ray_packet.h"
#include "q3map2/light/scene/light_embree.h"
#include "q3map2/shader/image_formats.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace q3 {

namespace {

/// Radiosity of a white wall that receives light 1, at LightmapOptions::bounceScale 1. The established program turns a
/// wall of luxel value 255 into an area light of 187.5, and an area light gives 3 times its value at form factor 1.
constexpr float kLegacyRadiosity = 187.5f * 3 / 255;
/// The same with -reflectivity linear: a white wall reflects all light at the default bounceScale of 0.25.
constexpr float kLinearRadiosity = 4;
/// Textures are averaged down to at most this many texels on a side, since a luxel covers several texels.
constexpr int kTextureSide = 16;
/// The surface under a luxel is searched down to this depth below its position. Game units.
constexpr float kSurfaceDepth = 16;

/// Reflectance of a texture, 0 to 1, at low resolution.
class CoarseTexture {
  public:
    CoarseTexture(const ShaderInfo &shader, const LightmapOptions &options);
    Vec3f At(const std::array<float, 2> &st) const {
        const auto texel = [](float t, int size) {
            const float part = t - std::floor(t);
            return std::isfinite(part) ? std::clamp(int(part * float(size)), 0, size - 1) : 0;
        };
        return texels_[std::size_t(texel(st[1], height_)) * std::size_t(width_) + std::size_t(texel(st[0], width_))];
    }

  private:
    int width_ = 1, height_ = 1;
    std::vector<Vec3f> texels_;
};

CoarseTexture::CoarseTexture(const ShaderInfo &shader, const LightmapOptions &options) {
    const auto color = [&](Vec3f c) {
        if (options.sRgbTexture || options.linearReflectance)
            c = {LinearFromSrgb(c.x), LinearFromSrgb(c.y), LinearFromSrgb(c.z)};
        const float gray = (c.x + c.y + c.z) / 3, ratio = options.bounceColorRatio;
        return c * ratio + Vec3f{gray, gray, gray} * (1 - ratio);
    };
    if (!shader.imageFound || !shader.lightImage) {
        texels_ = {color(shader.averageColor / 255)};
        return;
    }
    const Image &image = *shader.lightImage;
    width_ = std::min(kTextureSide, image.width), height_ = std::min(kTextureSide, image.height);
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            const int left = x * image.width / width_, right = (x + 1) * image.width / width_;
            const int top = y * image.height / height_, bottom = (y + 1) * image.height / height_;
            Vec3f sum;
            for (int row = top; row < bottom; ++row)
                for (int column = left; column < right; ++column) {
                    const auto rgba = image.Texel(column, row);
                    sum += color(Vec3f{float(rgba[0]), float(rgba[1]), float(rgba[2])} / 255);
                }
            texels_.push_back(sum / float((right - left) * (bottom - top)));
        }
}

/// Texels at the rim of a surface may have light but no surface under their center: they get the mean reflectance of
/// their neighbors.
void FillUnmapped(const RawLightmap &raw, std::span<Vec3f> texels) {
    const std::vector<Vec3f> own(texels.begin(), texels.end());
    for (int y = 0; y < raw.height; ++y)
        for (int x = 0; x < raw.width; ++x) {
            if (own[raw.Index(x, y)] != Vec3f{})
                continue;
            Vec3f sum;
            float count = 0;
            for (int ny = std::max(0, y - 1); ny <= std::min(raw.height - 1, y + 1); ++ny)
                for (int nx = std::max(0, x - 1); nx <= std::min(raw.width - 1, x + 1); ++nx)
                    if (own[raw.Index(nx, ny)] != Vec3f{})
                        sum += own[raw.Index(nx, ny)], count += 1;
            if (count > 0)
                texels[raw.Index(x, y)] = sum / count;
        }
}

} // namespace

bool IsInBounceScene(const SurfaceInputs &in, std::size_t surface) {
    const ShaderInfo &shader = *in.table[surface].shader;
    const bspShader_t &record = in.bsp.shaders[std::size_t(in.bsp.drawSurfaces[surface].shaderNum)];
    return (shader.compileFlags & (C_NODRAW | C_TRANSLUCENT | C_SKY)) == 0 && !shader.autosprite &&
           (record.surfaceFlags & in.options.noDrawSurfaceFlags) == 0;
}

float BounceScale(const SurfaceInputs &in, std::size_t surface) {
    return (in.lightmap.linearReflectance ? kLinearRadiosity : kLegacyRadiosity) *
           in.table[surface].shader->bounceScale * in.lightmap.bounceScale;
}

struct BounceScene::State {
    struct Triangle {
        int surface = 0;
        std::array<FaceCorner, 3> corners;
        Vec3f normal; // on the front side, not normalized
        bool emits = false, twoSided = false;
    };
    struct Hit {
        const Triangle *triangle = nullptr; // null: a miss, or a surface that does not emit
        float u = 0, v = 0;
        bool back = false; // whether the ray hit the back of a one-sided surface
    };
    std::vector<Triangle> triangles;
    const SurfaceInputs &in;
    const SurfaceLight &surfaces;
    const EmitterIndex &emitters;
    std::map<const ShaderInfo *, CoarseTexture> textures;
    DevicePtr device;
    ScenePtr scene;

    State(const SurfaceInputs &inputs, const SurfaceLight &light, const EmitterIndex &numbers)
        : in(inputs), surfaces(light), emitters(numbers) {}

    void Add(int surface, const FaceCorner &a, const FaceCorner &b, const FaceCorner &c, const Vec3f &front, bool emits,
             bool twoSided) {
        Vec3f normal = Cross(c.xyz - a.xyz, b.xyz - a.xyz);
        if (Dot(normal, front) < 0)
            normal = -normal;
        triangles.push_back({surface, {a, b, c}, normal, emits, twoSided});
    }
    void AddSurface(int number);
    void Commit();
    std::array<Hit, kPacketSize> Trace(const RayPacket &rays, bool coherent) const;
    EmitterId EmitterAt(const Hit &hit) const;
    Vec3f ColorAt(int surface, const std::array<float, 2> &st) const {
        constexpr Vec3f kMost{kMaxReflectance, kMaxReflectance, kMaxReflectance};
        const CoarseTexture &texture = textures.at(in.table[std::size_t(surface)].shader);
        return Min(texture.At(st) * BounceScale(in, std::size_t(surface)), kMost);
    }
};

void BounceScene::State::AddSurface(int number) {
    const auto index = std::size_t(number);
    const ShaderInfo &shader = *in.table[index].shader;
    if (!IsInBounceScene(in, index))
        return;
    const bool emits = shader.bounceScale > 0;
    if (emits)
        textures.try_emplace(&shader, shader, in.lightmap);
    for (const Face &face : FacesOf(in, surfaces, index)) {
        Vec3f front;
        for (const FaceCorner &corner : face)
            front += corner.normal;
        for (std::size_t i = 2; i < face.size(); ++i)
            Add(number, face[0], face[i - 1], face[i], front, emits, shader.twoSided);
    }
}

void BounceScene::State::Commit() {
    device = NewDevice();
    scene = NewScene(device.get());
    if (triangles.empty())
        return rtcCommitScene(scene.get());
    std::vector<float> corners;
    corners.reserve(9 * triangles.size());
    for (const Triangle &triangle : triangles)
        for (const FaceCorner &corner : triangle.corners)
            corners.insert(corners.end(), {corner.xyz.x, corner.xyz.y, corner.xyz.z});
    const GeometryPtr geometry = NewTriangles(device.get(), corners);
    rtcAttachGeometry(scene.get(), geometry.get());
    rtcCommitScene(scene.get());
}

std::array<BounceScene::State::Hit, kPacketSize> BounceScene::State::Trace(const RayPacket &rays, bool coherent) const {
    alignas(64) RTCRayHit16 hits;
    SetRays(rays.origin, rays.direction, rays.distance, rays.live, 0, hits.ray);
    std::fill(std::begin(hits.hit.geomID), std::end(hits.hit.geomID), RTC_INVALID_GEOMETRY_ID);
    EmbreeContext context;
    InitContext(context);
    Intersect16(rays.live.data(), scene.get(), context, hits, coherent);
    std::array<Hit, kPacketSize> found;
    for (std::size_t i = 0; i < kPacketSize; ++i)
        if (rays.live[i] != 0 && hits.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID) {
            const Triangle &triangle = triangles[hits.hit.primID[i]];
            if (!triangle.twoSided && !(Dot(triangle.normal, rays.direction[i]) < 0))
                found[i].back = true;
            else if (triangle.emits)
                found[i] = {&triangle, hits.hit.u[i], hits.hit.v[i], false};
        }
    return found;
}

EmitterId BounceScene::State::EmitterAt(const Hit &hit) const {
    const auto &c = hit.triangle->corners;
    const float weights[3] = {1 - hit.u - hit.v, hit.u, hit.v};
    const int lightmap = surfaces.lightmapOf[std::size_t(hit.triangle->surface)];
    if (lightmap < 0) {
        const auto nearest = std::max_element(std::begin(weights), std::end(weights)) - std::begin(weights);
        return emitters.Vertex(c[std::size_t(nearest)].vertex);
    }
    const RawLightmap &raw = surfaces.lightmaps[std::size_t(lightmap)];
    const auto texel = [&](std::size_t axis, int size) {
        const float at = weights[0] * c[0].luxel[axis] + weights[1] * c[1].luxel[axis] + weights[2] * c[2].luxel[axis];
        return std::clamp(int(at) / raw.super, 0, size - 1);
    };
    return emitters.Texel(std::size_t(lightmap), texel(0, raw.width), texel(1, raw.height));
}

EmitterIndex::EmitterIndex(const SurfaceLight &surfaces) {
    for (const RawLightmap &raw : surfaces.lightmaps) {
        first_.push_back(EmitterId(count_));
        widths_.push_back(raw.width);
        count_ += std::size_t(raw.width) * std::size_t(raw.height);
    }
    first_.push_back(EmitterId(count_));
    count_ += surfaces.verts.size();
    if (count_ >= kBackOfSurface)
        throw Error("bounced light: {} luxels are too many", count_);
}

BounceScene::BounceScene(const SurfaceInputs &in, const SurfaceLight &surfaces, const EmitterIndex &emitters)
    : state_(std::make_unique<State>(in, surfaces, emitters)) {
    for (std::size_t i = 0; i < in.bsp.drawSurfaces.size(); ++i)
        state_->AddSurface(int(i));
    state_->Commit();
    FindReflectance(in, surfaces, emitters);
}

BounceScene::~BounceScene() = default;

std::array<EmitterId, kPacketSize> BounceScene::FirstEmitters(const RayPacket &rays, bool coherent) const {
    std::array<EmitterId, kPacketSize> found;
    const auto hits = state_->Trace(rays, coherent);
    for (std::size_t i = 0; i < kPacketSize; ++i)
        found[i] = hits[i].triangle ? state_->EmitterAt(hits[i]) : hits[i].back ? kBackOfSurface : kNoEmitter;
    return found;
}

void BounceScene::TraceOccluded(RayPacket &rays) const {
    alignas(64) RTCRay16 shadow;
    SetRays(rays.origin, rays.direction, rays.distance, rays.live, 0, shadow);
    EmbreeContext context;
    InitContext(context);
    Occluded16(rays.live.data(), state_->scene.get(), context, shadow);
    for (const std::size_t i : kEachLane)
        rays.live[i] &= shadow.tfar[i] < 0 ? 0 : -1;
}

void BounceScene::FindReflectance(const SurfaceInputs &in, const SurfaceLight &surfaces, const EmitterIndex &emitters) {
    reflectance_.assign(emitters.Count(), {});
    in.jobs.For(std::int64_t(surfaces.lightmaps.size()), [&](std::int64_t number, int) {
        const RawLightmap &raw = surfaces.lightmaps[std::size_t(number)];
        auto rays = MakeRayBatcher<std::size_t>([&](RayPacket &packet, std::span<const std::size_t> texels) {
            const auto hits = state_->Trace(packet, false);
            for (std::size_t i = 0; i < texels.size(); ++i)
                if (const auto *triangle = hits[i].triangle) {
                    const auto &c = triangle->corners;
                    const auto st = [&](std::size_t axis) {
                        return (1 - hits[i].u - hits[i].v) * c[0].st[axis] + hits[i].u * c[1].st[axis] +
                               hits[i].v * c[2].st[axis];
                    };
                    reflectance_[emitters.FirstOf(std::size_t(number)) + texels[i]] =
                        state_->ColorAt(triangle->surface, {st(0), st(1)});
                }
        });
        for (int y = 0; y < raw.height; ++y)
            for (int x = 0; x < raw.width; ++x) {
                const int half = raw.super / 2;
                const std::size_t luxel = raw.SuperIndex(x * raw.super + half, y * raw.super + half);
                if (!raw.Mapped(luxel))
                    continue;
                rays.Aim(raw.Index(x, y), raw.positions[luxel] + raw.normals[luxel],
                         raw.positions[luxel] - raw.normals[luxel] * kSurfaceDepth);
            }
        rays.Flush();
        FillUnmapped(
            raw, std::span(reflectance_)
                     .subspan(emitters.FirstOf(std::size_t(number)), std::size_t(raw.width) * std::size_t(raw.height)));
    });
    for (std::size_t i = 0; i < in.bsp.drawSurfaces.size(); ++i) {
        const bspDrawSurface_t &surface = in.bsp.drawSurfaces[i];
        const auto texture = state_->textures.find(in.table[i].shader);
        if (surfaces.lightmapOf[i] >= 0 || texture == state_->textures.end())
            continue;
        for (int v = surface.firstVert; v < surface.firstVert + surface.numVerts; ++v)
            reflectance_[emitters.Vertex(v)] = state_->ColorAt(int(i), surfaces.verts[std::size_t(v)].st);
    }
}

} // namespace q3
