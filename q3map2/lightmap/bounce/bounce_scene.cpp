// GPL-2.0-or-later. The surfaces that reflect bounced light, as a scene for gather rays.
#include "q3map2/lightmap/bounce/bounce_scene.h"

#include "common/error.h"
#include "q3map2/light/batch/receivers.h"
#include "q3map2/lightmap/raw/face_scene.h"
#include "q3map2/shader/image_formats.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace q3 {

namespace {

/// Radiosity of a white wall that receives light 1, at LightmapOptions::bounceScale 1. NetRadiant's q3map2 turns a
/// wall of luxel value 255 into an area light of 187.5, and an area light gives 3 times its value at form factor 1.
constexpr float kLegacyRadiosity = 187.5f * 3 / 255;
/// The same with -reflectivity linear: 1 / 0.25, since a white wall reflects all light at the default bounceScale of
/// 0.25.
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
    const auto reflectanceOf = [&](Vec3f c) {
        if (options.sRgbTexture || options.linearReflectance)
            c = {LinearFromSrgb(c.x), LinearFromSrgb(c.y), LinearFromSrgb(c.z)};
        const float gray = (c.x + c.y + c.z) / 3, ratio = options.bounceColorRatio;
        return c * ratio + Vec3f{gray, gray, gray} * (1 - ratio);
    };
    if (!shader.imageFound || !shader.lightImage) {
        texels_ = {reflectanceOf(shader.averageColor / 255)};
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
                    sum += reflectanceOf(Vec3f{float(rgba[0]), float(rgba[1]), float(rgba[2])} / 255);
                }
            texels_.push_back(sum / float((right - left) * (bottom - top)));
        }
}

/// Texels at the rim of a surface may have light but no surface under their center: they get the mean reflectance of
/// their neighbors.
void FillUnmapped(const RawLightmap &raw, std::span<Vec3f> texels) {
    const std::vector<Vec3f> before(texels.begin(), texels.end());
    for (int y = 0; y < raw.height; ++y)
        for (int x = 0; x < raw.width; ++x) {
            if (before[raw.Index(x, y)] != Vec3f{})
                continue;
            Vec3f sum;
            float count = 0;
            ForNeighborhood(x, y, raw.width, raw.height, [&](int nx, int ny) {
                if (const Vec3f &neighbor = before[raw.Index(nx, ny)]; neighbor != Vec3f{})
                    sum += neighbor, count += 1;
            });
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
    /// What a ray meets on the surface.
    struct SurfaceTraits {
        bool emits = false, twoSided = false;
    };
    FaceScene faces;
    std::vector<SurfaceTraits> traits; ///< by draw surface
    const SurfaceInputs &in;
    const SurfaceLight &surfaces;
    const EmitterIndex &emitters;
    std::map<const ShaderInfo *, CoarseTexture> textures;

    State(const SurfaceInputs &inputs, const SurfaceLight &light, const EmitterIndex &numbers)
        : traits(inputs.bsp.drawSurfaces.size()), in(inputs), surfaces(light), emitters(numbers) {}

    void AddSurface(int number);
    EmitterId EmitterAt(const FaceTriangle &triangle, float u, float v) const;
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
    traits[index] = {shader.bounceScale > 0, shader.twoSided};
    if (traits[index].emits)
        textures.try_emplace(&shader, shader, in.lightmap);
    for (const Face &face : FacesOf(in, surfaces, index))
        faces.Add(number, face);
}

EmitterId BounceScene::State::EmitterAt(const FaceTriangle &triangle, float u, float v) const {
    const int lightmap = surfaces.lightmapOf[std::size_t(triangle.surface)];
    if (lightmap < 0)
        return emitters.Vertex(triangle.NearestVertex(u, v));
    const RawLightmap &raw = surfaces.lightmaps[std::size_t(lightmap)];
    const std::array<float, 2> luxel = triangle.LuxelAt(u, v);
    const auto texel = [&](float at, int size) { return LuxelOf(at, size * raw.super) / raw.super; };
    return emitters.Texel(std::size_t(lightmap), texel(luxel[0], raw.width), texel(luxel[1], raw.height));
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
    state_->faces.Commit();
    FindReflectance(in, surfaces, emitters);
}

BounceScene::~BounceScene() = default;

std::array<EmitterId, kPacketSize> BounceScene::FirstEmitters(const RayPacket &rays, RayCoherence coherence) const {
    const FaceScene::Hits hits = state_->faces.FirstHits(rays, coherence);
    std::array<EmitterId, kPacketSize> found;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        found[i] = kNoEmitter;
        if (!hits.triangle[i])
            continue;
        const auto [emits, twoSided] = state_->traits[std::size_t(hits.triangle[i]->surface)];
        if (!twoSided && !hits.InFront(i, rays))
            found[i] = kBackOfSurface;
        else if (emits)
            found[i] = state_->EmitterAt(*hits.triangle[i], hits.u[i], hits.v[i]);
    }
    return found;
}

void BounceScene::TraceOccluded(RayPacket &rays) const {
    state_->faces.TraceOccluded(rays);
}

void BounceScene::FindReflectance(const SurfaceInputs &in, const SurfaceLight &surfaces, const EmitterIndex &emitters) {
    reflectance_.assign(emitters.Count(), {});
    in.jobs.For(std::int64_t(surfaces.lightmaps.size()), [&](std::int64_t number, int) {
        const RawLightmap &raw = surfaces.lightmaps[std::size_t(number)];
        auto rays = MakeRayBatcher<std::size_t>([&](RayPacket &packet, std::span<const std::size_t> texels) {
            const FaceScene::Hits hits = state_->faces.FirstHits(packet, RayCoherence::Incoherent);
            for (std::size_t i = 0; i < texels.size(); ++i) {
                if (!hits.triangle[i])
                    continue;
                const FaceTriangle &triangle = *hits.triangle[i];
                const auto [emits, twoSided] = state_->traits[std::size_t(triangle.surface)];
                if (emits && (twoSided || hits.InFront(i, packet)))
                    reflectance_[emitters.FirstOf(std::size_t(number)) + texels[i]] =
                        state_->ColorAt(triangle.surface, triangle.TextureAt(hits.u[i], hits.v[i]));
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
