// GPL-2.0-or-later. Under -fast: surfaces cut into patches as by NetRadiant's q3map2, and which of them are too
// faint to light a receiver.
#include "q3map2/lightmap/bounce/faint_patches.h"

#include "libs/math/winding.h"
#include "q3map2/light/batch/form_factor.h"
#include "q3map2/lightmap/raw/luxel_raster.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// Longest side of a patch's bounds. Where light varies it is halved repeatedly, down to kMinPatchSize. Game units.
constexpr float kPatchSize = 256, kMinPatchSize = 64;
/// Light varies much if (max - min) * max is above this in a channel; 1 is white.
constexpr float kLightVaries = 0.75f;
constexpr float kOnCut = 0.125f; ///< corners this near to a cut count as on it. Game units
/// Patches with an area outside this range emit no light, as in NetRadiant's q3map2. Square game units.
constexpr double kMinArea = 1, kMaxArea = 20'000'000;
/// Polygons with a larger coordinate are skipped as damaged: no map is so large. Game units.
constexpr float kMaxCoordinate = 262144;

/// A quad stays whole if its fourth corner is this near to the plane of its other corners. Game units.
constexpr float kFlatQuad = 0.1f;
/// LightVaries samples a triangle at barycentric weights i : j : k, each 1 to kMaxWeight; at most kMaxSamples for a
/// polygon.
constexpr int kMaxWeight = 5, kMaxSamples = 150;
/// For form factors, receivers nearer to the plane of a patch than this are moved to this height over it. Game units.
constexpr float kMinHeight = 8;
/// NetRadiant's q3map2 compares a form factor with the tolerance that is not clipped at the receiver's horizon: the
/// part of the patch behind the receiver counts negative, so that less light near the patch's plane counts. This does
/// too. Up to kMinHeight off the patch's plane, ContributionFraction is the unclipped / the clipped form factor; from
/// there it rises linearly to 1 at kClipHeight. Game units.
constexpr float kClipHeight = 16;
/// Receivers farther than this behind Patch::origin's plane, which is 1 unit in front of the patch, are behind the
/// patch. 0.01 is for rounding. Game units.
constexpr float kBehindPlane = 1.01f;
/// Beyond kFarRadii radii a patch is taken as a point source. Nearer, the exact form factor is not computed if that of
/// a point source exceeds the tolerance kPointMargin times.
constexpr float kFarRadii = 3, kPointMargin = 4;

FaceCorner Lerp(const FaceCorner &a, const FaceCorner &b, float t) {
    FaceCorner c;
    c.xyz = a.xyz + (b.xyz - a.xyz) * t;
    c.normal = Normalize(a.normal + (b.normal - a.normal) * t);
    for (std::size_t i = 0; i < 2; ++i)
        c.luxel[i] = a.luxel[i] + (b.luxel[i] - a.luxel[i]) * t;
    c.vertex = t < 0.5f ? a.vertex : b.vertex;
    return c;
}

Winding<float> WindingOf(const Face &face) {
    Winding<float> w;
    for (const FaceCorner &corner : face)
        w.push_back(corner.xyz);
    return w;
}

/// Form factor of a convex polygon, clipped at the horizon of the point.
float ClippedFormFactor(const Vec3f &p, const Vec3f &n, std::span<const Vec3f> w) {
    float total = 0;
    Vec3f u = w.back() - p, leaves, enters;
    float before = Dot(n, u);
    for (const Vec3f &corner : w) {
        const Vec3f v = corner - p;
        const float after = Dot(n, v);
        if ((before >= 0) != (after >= 0)) {
            const Vec3f cut = u + (v - u) * (before / (before - after));
            total += before >= 0 ? EdgeTerm(u, cut, n) : EdgeTerm(cut, v, n);
            (before >= 0 ? leaves : enters) = cut;
        } else if (before >= 0) {
            total += EdgeTerm(u, v, n);
        }
        u = v, before = after;
    }
    return (total + EdgeTerm(leaves, enters, n)) / (2 * std::numbers::pi_v<float>);
}

bool HoldsLight(const RawLightmap &raw, std::size_t texel) {
    return std::any_of(raw.radiosity.begin(), raw.radiosity.end(),
                       [&](const auto &slot) { return !slot.empty() && slot[texel].x >= 0; });
}

/// Appends the face, or two triangles if it is a quad that is not flat.
void AppendFlatFaces(Face face, std::vector<Face> &flat) {
    if (face.size() == 4) {
        const Vec3f normal = Normalize(Cross(face[2].xyz - face[0].xyz, face[1].xyz - face[0].xyz));
        if (normal == Vec3f{} || std::abs(Dot(normal, face[3].xyz - face[0].xyz)) >= kFlatQuad) {
            flat.push_back({face[0], face[1], face[2]});
            face = {face[0], face[2], face[3]};
        }
    }
    flat.push_back(std::move(face));
}

} // namespace

/// Subdivides the faces of surfaces into patches.
struct FaintPatches::PatchBuilder {
    FaintPatches &result;
    const SurfaceInputs &in;
    const SurfaceLight &surfaces;
    const EmitterIndex &emitters;
    std::span<const Vec3f> emission;
    std::size_t surface = 0;
    bool mayVary = false;                       ///< false: the surface is too dark for LightVaries to hold anywhere
    std::vector<std::uint8_t> centerFound = {}; ///< by emitter: not 0 if the texel's center is in its patch
    std::vector<std::pair<Face, float>> pending = {}; ///< faces still to cut, with the longest side allowed

    const RawLightmap *Lightmap() const {
        const int lightmap = surfaces.lightmapOf[surface];
        return lightmap < 0 ? nullptr : &surfaces.lightmaps[std::size_t(lightmap)];
    }
    EmitterId Texel(int x, int y) const { return emitters.Texel(std::size_t(surfaces.lightmapOf[surface]), x, y); }
    void Begin(std::size_t number);
    void Add(Face first);
    bool LightVaries(const Face &face) const;
    void AddPatch(const Face &face, double area);
    void AssignTexels(const Face &face, std::uint32_t patch, const RawLightmap &raw);
};

void FaintPatches::PatchBuilder::Begin(std::size_t number) {
    surface = number;
    const auto most = [&](EmitterId first, std::size_t count) {
        float value = 0;
        for (const Vec3f &one : emission.subspan(first, count))
            value = std::max(value, MaxComponent(one));
        return value;
    };
    const bspDrawSurface_t &record = in.bsp.drawSurfaces[number];
    const RawLightmap *raw = Lightmap();
    const float value = raw ? most(Texel(0, 0), std::size_t(raw->width) * std::size_t(raw->height))
                            : most(emitters.Vertex(record.firstVert), std::size_t(record.numVerts));
    const float full = 255 * BounceScale(in, number);
    mayVary = value * value > kLightVaries * full * full;
}

void FaintPatches::PatchBuilder::Add(Face first) {
    for (const FaceCorner &corner : first)
        if (!IsFinite(corner.xyz) || MaxAbsComponent(corner.xyz) > kMaxCoordinate)
            return;
    const float least = LeastPieceSize(WindingOf(first));
    const float wanted = in.table[surface].shader->lightSubdivide;
    pending.emplace_back(std::move(first), std::max(wanted > 0 ? wanted : kPatchSize, least));
    while (!pending.empty()) {
        auto [face, size] = std::move(pending.back());
        pending.pop_back();
        const Winding<float> w = WindingOf(face);
        const Boundsf box = WindingBounds(w);
        std::size_t axis = 0;
        while (axis < 3 && !(box.maxs[axis] - box.mins[axis] > size))
            ++axis;
        if (axis < 3) {
            Face front, back;
            CutAcrossAxis(face, axis, box.Center()[axis], kOnCut, Lerp, front, back);
            if (back.size() >= 3)
                pending.emplace_back(std::move(back), size);
            if (front.size() >= 3)
                pending.emplace_back(std::move(front), size);
            continue;
        }
        const double area = WindingArea(w);
        if (!(area >= kMinArea && area <= kMaxArea))
            continue;
        if (mayVary && size > kMinPatchSize && LightVaries(face))
            pending.emplace_back(std::move(face), size / 2);
        else
            AddPatch(face, area);
    }
}

bool FaintPatches::PatchBuilder::LightVaries(const Face &face) const {
    Vec3f least{1e30f, 1e30f, 1e30f}, most;
    const auto take = [&](const Vec3f &light) { least = Min(least, light), most = Max(most, light); };
    const RawLightmap *raw = Lightmap();
    if (!raw)
        for (const FaceCorner &corner : face)
            take(emission[emitters.Vertex(corner.vertex)]);
    int samples = 0;
    for (std::size_t v = 1; raw && v + 1 < face.size(); ++v)
        for (int i = 1; i <= kMaxWeight; ++i)
            for (int j = 1; j <= kMaxWeight; ++j)
                for (int k = 1; k <= kMaxWeight && samples < kMaxSamples; ++k, ++samples) {
                    const auto texel = [&](std::size_t axis, int size) {
                        const float at = float(i) * face[0].luxel[axis] + float(j) * face[v].luxel[axis] +
                                         float(k) * face[v + 1].luxel[axis];
                        return LuxelOf(at / float(i + j + k), size * raw->super) / raw->super;
                    };
                    const int x = texel(0, raw->width), y = texel(1, raw->height);
                    if (HoldsLight(*raw, raw->Index(x, y)))
                        take(emission[Texel(x, y)]);
                }
    const Vec3f range = (most - least) * most;
    const float full = 255 * BounceScale(in, surface);
    return MaxComponent(range) > kLightVaries * full * full;
}

void FaintPatches::PatchBuilder::AddPatch(const Face &face, double area) {
    const ShaderInfo &shader = *in.table[surface].shader;
    Patch patch;
    Vec3f mean;
    for (const FaceCorner &corner : face)
        patch.normal += corner.normal, mean += corner.xyz / float(face.size());
    patch.normal = Normalize(patch.normal);
    if (patch.normal == Vec3f{})
        return;
    const Winding<float> w = WindingOf(face);
    Vec3d center;
    for (std::size_t i = 2; i < w.size(); ++i)
        center += Vec3d(w[0] + w[i - 1] + w[i]) * (WindingArea(Winding<float>{w[0], w[i - 1], w[i]}) / 3);
    patch.center = Vec3f(center / area);
    patch.areaNormal = -Vec3f(WindingAreaVector(w));
    patch.origin = mean + patch.normal;
    patch.dist = Dot(patch.origin, patch.normal);
    // Light of a white patch in white light at form factor 1, byte scale.
    const float add = 255 * std::abs(BounceScale(in, surface));
    patch.minFormFactor = shader.noFast ? -2 : in.options.tolerance / add; // form factors are -1 to 1
    float radius = 0;
    for (const Vec3f &p : w)
        radius = std::max(radius, Length(p - patch.center));
    patch.farDistance2 = kFarRadii * kFarRadii * radius * radius;
    patch.twoSided = shader.twoSided || (shader.compileFlags & C_FOG) != 0;
    patch.first = std::uint32_t(result.corners_.size()), patch.count = std::uint32_t(w.size());
    const auto number = std::uint32_t(result.patches_.size());
    result.patches_.push_back(patch);
    result.corners_.insert(result.corners_.end(), w.begin(), w.end());
    if (const RawLightmap *raw = Lightmap())
        return AssignTexels(face, number, *raw);
    for (const FaceCorner &corner : face)
        if (std::uint32_t &known = result.patchOf_[emitters.Vertex(corner.vertex)];
            known == kNone || Length(result.patches_[known].areaNormal) < Length(patch.areaNormal))
            known = number;
}

/// Assigns texels to the patch that holds their center, else to the first patch whose bounds they overlap.
void FaintPatches::PatchBuilder::AssignTexels(const Face &face, std::uint32_t patch, const RawLightmap &raw) {
    std::vector<std::array<float, 2>> corners; // in texels
    std::array<float, 2> least{1e30f, 1e30f}, most{-1e30f, -1e30f};
    for (const FaceCorner &corner : face) {
        corners.push_back({corner.luxel[0] / float(raw.super), corner.luxel[1] / float(raw.super)});
        for (std::size_t axis = 0; axis < 2; ++axis)
            least[axis] = std::min(least[axis], corners.back()[axis]),
            most[axis] = std::max(most[axis], corners.back()[axis]);
    }
    const auto inside = [&](float x, float y) {
        bool left = false, right = false;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const auto &a = corners[i], &b = corners[(i + 1) % corners.size()];
            const float side = (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
            left |= side > 0, right |= side < 0;
        }
        return !(left && right);
    };
    for (int y = LuxelOf(least[1], raw.height); y <= LuxelOf(most[1], raw.height); ++y)
        for (int x = LuxelOf(least[0], raw.width); x <= LuxelOf(most[0], raw.width); ++x) {
            const EmitterId texel = Texel(x, y);
            const bool holdsCenter = centerFound[texel] == 0 && inside(float(x) + 0.5f, float(y) + 0.5f);
            if (holdsCenter || result.patchOf_[texel] == kNone)
                result.patchOf_[texel] = patch;
            centerFound[texel] |= std::uint8_t(holdsCenter);
        }
}

FaintPatches::FaintPatches(const SurfaceInputs &in, const SurfaceLight &surfaces, const EmitterIndex &emitters,
                           std::span<const Vec3f> emission)
    : patchOf_(emitters.Count(), kNone) {
    PatchBuilder builder{*this, in, surfaces, emitters, emission};
    builder.centerFound.resize(emitters.Count());
    std::vector<Face> flat;
    for (std::size_t i = 0; i < in.bsp.drawSurfaces.size(); ++i) {
        if (!IsInBounceScene(in, i) || !(in.table[i].shader->bounceScale > 0))
            continue;
        builder.Begin(i);
        flat.clear();
        for (Face &face : FacesOf(in, surfaces, i))
            AppendFlatFaces(std::move(face), flat);
        for (Face &face : flat)
            builder.Add(std::move(face));
    }
}

float FaintPatches::PatchContributionFraction(const Patch &patch, const Vec3f &position, const Vec3f &normal,
                                              bool twoSided) const {
    const float signedHeight = Dot(position, patch.normal) - patch.dist;
    if ((!patch.twoSided && signedHeight < -kBehindPlane) || (!twoSided && Dot(patch.origin - position, normal) < 0))
        return 0;
    const float height = std::abs(signedHeight);
    const Vec3f p = height < kMinHeight ? position + patch.normal * (kMinHeight - signedHeight) : position;
    const Vec3f toCenter = patch.center - p;
    const float distance2 = Dot(toCenter, toCenter), along = Dot(normal, toCenter);
    const bool anySide = patch.twoSided || twoSided;
    const auto enough = [&](float factor, float least) { return (anySide ? std::abs(factor) : factor) > least; };
    // With c = toCenter and A = areaNormal, a point source has the form factor -(n . c) (A . c) / (pi |c|^4): compared
    // without the division.
    const float asPoint = -along * Dot(patch.areaNormal, toCenter);
    const float least = patch.minFormFactor * std::numbers::pi_v<float> * distance2 * distance2;
    // Clipped unless the bounding sphere of the patch is wholly above the receiver's horizon: along > radius.
    const bool clips =
        height < kClipHeight && !(along > 0 && kFarRadii * kFarRadii * along * along > patch.farDistance2);
    if (distance2 > patch.farDistance2 || (!clips && asPoint > kPointMargin * least))
        return enough(asPoint, least) ? 1 : 0;
    const auto corners = std::span(corners_).subspan(patch.first, patch.count);
    const float unclipped = FormFactor(p, normal, corners);
    if (!enough(unclipped, patch.minFormFactor))
        return 0;
    if (!clips)
        return 1;
    const float clipped = ClippedFormFactor(p, normal, corners);
    const float ratio = clipped != 0 ? std::clamp(unclipped / clipped, 0.0f, 1.0f) : 0;
    const float nearness = std::min(1.0f, (kClipHeight - height) / (kClipHeight - kMinHeight)); // 1 up to kMinHeight
    return 1 - (1 - ratio) * nearness;
}

} // namespace q3
