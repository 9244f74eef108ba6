// GPL-2.0-or-later. Radiosity: bounced light on surfaces.
#include "q3map2/lightmap/bounce/light_bounce.h"

#include <algorithm>

namespace q3 {

namespace {

/// Vertices gather at points moved this far, but at most a quarter of the way, to the center of their surface, since
/// its edge often lies in the plane of another surface. Game units.
constexpr float kInward = 2;

/// The slot of a style, claimed if the style is new; kStyles if other styles hold all slots.
std::size_t ClaimSlot(Styles &styles, std::uint8_t style) {
    const std::size_t slot = StyleSlotFor(styles, style);
    if (slot < kStyles)
        styles[slot] = style;
    return slot;
}

} // namespace

Bounces::Bounces(const SurfaceInputs &in, const SurfaceLight &surfaces)
    : in_(in), emitters_(surfaces), scene_(in, surfaces, emitters_),
      patches_(in.options.fast ? MakePatches(surfaces) : nullptr), gather_(in, surfaces, scene_, patches_.get()),
      total_(emitters_.Count()) {}

void Bounces::CollectStyle(const SurfaceLight &surfaces, std::uint8_t style, Emission &emission) const {
    const std::vector<Vec3f> &reflectance = scene_.Reflectance();
    emission.assign(emitters_.Count(), {});
    for (std::size_t i = 0; i < surfaces.lightmaps.size(); ++i) {
        const RawLightmap &raw = surfaces.lightmaps[i];
        const std::size_t slot = FindStyleSlot(raw.styles, style);
        if (slot >= kStyles || raw.radiosity[slot].empty())
            continue;
        const EmitterId first = emitters_.FirstOf(i);
        for (std::size_t t = 0; t < raw.radiosity[slot].size(); ++t)
            emission[first + t] = Max(raw.radiosity[slot][t], Vec3f{}) * reflectance[first + t];
    }
    for (std::size_t i = 0; i < in_.bsp.drawSurfaces.size(); ++i) {
        const bspDrawSurface_t &surface = in_.bsp.drawSurfaces[i];
        const std::size_t slot = surfaces.lightmapOf[i] < 0 ? FindStyleSlot(surfaces.vertex.styles[i], style) : kStyles;
        if (slot >= kStyles || surfaces.vertex.radiosity[slot].empty())
            continue;
        for (int v = surface.firstVert; v < surface.firstVert + surface.numVerts; ++v)
            emission[emitters_.Vertex(v)] =
                Max(surfaces.vertex.radiosity[slot][std::size_t(v)], Vec3f{}) * reflectance[emitters_.Vertex(v)];
    }
}

std::vector<std::uint8_t> Bounces::UsedStyles(const SurfaceLight &surfaces) {
    std::vector<std::uint8_t> styles{0};
    const auto add = [&](const Styles &some) {
        for (const std::uint8_t style : some)
            if (style != kNoStyle && std::find(styles.begin(), styles.end(), style) == styles.end())
                styles.push_back(style);
    };
    for (const RawLightmap &raw : surfaces.lightmaps)
        add(raw.styles);
    for (const Styles &vertexStyles : surfaces.vertex.styles)
        add(vertexStyles);
    return styles;
}

std::unique_ptr<const RadiosityPatches> Bounces::MakePatches(const SurfaceLight &surfaces) const {
    Emission all(emitters_.Count()), one;
    for (const std::uint8_t style : UsedStyles(surfaces)) {
        CollectStyle(surfaces, style, one);
        for (std::size_t i = 0; i < all.size(); ++i)
            all[i] += one[i];
    }
    return std::make_unique<const RadiosityPatches>(in_, surfaces, emitters_, all);
}

bool Bounces::CollectRadiosity(const SurfaceLight &surfaces) {
    byStyle_.clear();
    bool any = false;
    for (const std::uint8_t style : UsedStyles(surfaces)) {
        Emission &emission = byStyle_[style];
        CollectStyle(surfaces, style, emission);
        any = any || std::any_of(emission.begin(), emission.end(), [](const Vec3f &one) { return one != Vec3f{}; });
        if (style == 0)
            for (std::size_t i = 0; i < emission.size(); ++i)
                total_[i] += emission[i];
    }
    return any;
}

void Bounces::AddToLuxels(SurfaceLight &surfaces) const {
    std::vector<BounceEstimate> found(surfaces.lightmaps.size());
    std::vector<std::size_t> slots(surfaces.lightmaps.size());
    for (const auto &ofStyle : byStyle_) {
        const auto &style = ofStyle.first; // clang 14 cannot capture structured bindings
        const auto &emission = ofStyle.second;
        in_.jobs.For(std::int64_t(found.size()), [&](std::int64_t number, int) {
            const auto i = std::size_t(number);
            RawLightmap &raw = surfaces.lightmaps[i];
            slots[i] = ClaimSlot(raw.styles, style);
            found[i] = slots[i] < kStyles ? gather_.Gather(emission, i, slots[i], raw) : BounceEstimate{};
        });
        in_.jobs.For(std::int64_t(found.size()), [&](std::int64_t number, int) {
            const auto i = std::size_t(number);
            RawLightmap &raw = surfaces.lightmaps[i];
            if (slots[i] >= kStyles)
                return;
            raw.light[slots[i]].resize(raw.luxelClusters.size());
            raw.filled[slots[i]].resize(raw.luxelClusters.size());
            raw.directional[slots[i]].resize(raw.channels.Count());
            for (std::vector<Vec3f> &channel : raw.directional[slots[i]])
                channel.resize(raw.luxelClusters.size());
            for (std::size_t luxel = 0; luxel < raw.luxelClusters.size(); ++luxel)
                raw.filled[slots[i]][luxel] = raw.filled[slots[i]][luxel] || raw.Mapped(luxel);
            gather_.AddToLuxels(found, i, slots[i], raw);
        });
    }
}

void Bounces::AddToVertices(SurfaceLight &surfaces) const {
    VertexLight &vertex = surfaces.vertex;
    // Before the jobs: all surfaces share the vectors of a slot.
    for (const auto &[style, emission] : byStyle_)
        for (std::size_t i = 0; i < in_.bsp.drawSurfaces.size(); ++i)
            if (surfaces.lightmapOf[i] < 0)
                if (const std::size_t slot = ClaimSlot(vertex.styles[i], style); slot < kStyles) {
                    vertex.sum[slot].resize(surfaces.verts.size());
                    vertex.radiosity[slot].resize(surfaces.verts.size());
                }
    in_.jobs.For(std::int64_t(in_.bsp.drawSurfaces.size()), [&](std::int64_t number, int) {
        const auto i = std::size_t(number);
        const bspDrawSurface_t &surface = in_.bsp.drawSurfaces[i];
        if (surfaces.lightmapOf[i] >= 0 || in_.table[i].shader->lightmap.noVertexLight)
            return;
        Vec3f center;
        for (int v = surface.firstVert; v < surface.firstVert + surface.numVerts; ++v)
            center += surfaces.verts[std::size_t(v)].xyz / float(surface.numVerts);
        for (const auto &[style, emission] : byStyle_) {
            const std::size_t slot = FindStyleSlot(vertex.styles[i], style);
            if (slot >= kStyles)
                continue;
            for (int v = surface.firstVert; v < surface.firstVert + surface.numVerts; ++v) {
                const SurfaceVertex &at = surfaces.verts[std::size_t(v)];
                const Vec3f inward = center - at.xyz;
                const Vec3f position = at.xyz + inward * std::min(0.25f, kInward / std::max(1.0f, Length(inward)));
                const Vec3f light = gather_.IrradianceAt(position, at.normal, in_.table[i].shader->twoSided, emission);
                vertex.sum[slot][std::size_t(v)] += light;
                vertex.radiosity[slot][std::size_t(v)] += light;
            }
        }
    });
}

} // namespace q3
