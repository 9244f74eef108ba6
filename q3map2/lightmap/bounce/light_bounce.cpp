// GPL-2.0-or-later. Radiosity: bounced light on surfaces.
#include "q3map2/lightmap/bounce/light_bounce.h"

#include "q3map2/lightmap/bounce/vertex_receivers.h"
#include "q3map2/lightmap/raw/luxel_means.h"

#include <algorithm>

namespace q3 {

namespace {

/// Emitters are bright above this radiosity, and above this share of all others. Byte scale.
constexpr float kBright = 16, kBrightShare = 0.9f;

/// The slot of a style, claimed if the style is new; kStyles if other styles hold all slots.
std::size_t ClaimSlot(Styles &styles, std::uint8_t style) {
    const std::size_t slot = StyleSlotFor(styles, style);
    if (slot < kStyles)
        styles[slot] = style;
    return slot;
}

/// The radiosity above which emitters are bright.
float BrightLimit(const Emission &emission) {
    std::vector<float> lit;
    for (const Vec3f &one : emission)
        if (const float most = MaxComponent(one); most > 0)
            lit.push_back(most);
    if (lit.empty())
        return kBright;
    const auto at = lit.begin() + std::ptrdiff_t(kBrightShare * float(lit.size() - 1));
    std::nth_element(lit.begin(), at, lit.end());
    return std::max(kBright, *at);
}

void AddVectors(const std::vector<Vec3f> &values, std::vector<Vec3f> &to) {
    to.resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
        to[i] += values[i];
}

/// Adds to the light of a style slot.
void AddEstimate(const BounceEstimate &estimate, std::size_t slot, RawLightmap &raw) {
    AddVectors(estimate.irradiance, raw.light[slot]);
    raw.directional[slot].resize(raw.channels.Count());
    for (std::size_t c = 0; c < raw.channels.Count(); ++c)
        AddVectors(estimate.channels[c], raw.directional[slot][c]);
    if (!estimate.directions.empty())
        AddVectors(estimate.directions, raw.directions);
    raw.filled[slot].resize(raw.luxelClusters.size());
    for (std::size_t luxel = 0; luxel < raw.luxelClusters.size(); ++luxel)
        raw.filled[slot][luxel] = raw.filled[slot][luxel] || raw.Mapped(luxel);
}

} // namespace

Bounces::Bounces(const SurfaceInputs &in, const SurfaceLight &surfaces)
    : in_(in), emitters_(surfaces), scene_(in, surfaces, emitters_),
      patches_(in.options.fast ? MakePatches(surfaces) : nullptr), gather_(in, surfaces, scene_, patches_.get()) {}

Emission Bounces::FirstBounce(const SurfaceLight &surfaces, std::uint8_t style) const {
    const std::vector<Vec3f> &reflectance = scene_.Reflectance();
    Emission emission(emitters_.Count());
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
    return emission;
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
    Emission all(emitters_.Count());
    for (const std::uint8_t style : UsedStyles(surfaces)) {
        const Emission one = FirstBounce(surfaces, style);
        for (std::size_t i = 0; i < all.size(); ++i)
            all[i] += one[i];
    }
    return std::make_unique<const RadiosityPatches>(in_, surfaces, emitters_, all);
}

void Bounces::GatherBright(const SurfaceLight &surfaces, bool deluxe, StyleRadiosity &radiosity) const {
    const BrightEmitters &bright = *radiosity.bright;
    radiosity.brightOnLuxels.resize(surfaces.lightmaps.size());
    radiosity.brightOnVertices.resize(surfaces.verts.size());
    in_.jobs.For(std::int64_t(surfaces.lightmaps.size()), [&](std::int64_t i, int) {
        const RawLightmap &raw = surfaces.lightmaps[std::size_t(i)];
        BounceEstimate &estimate = radiosity.brightOnLuxels[std::size_t(i)] = BounceEstimate(raw, deluxe);
        if (!bright.Empty())
            bright.AddToLuxels(raw, gather_.Origins(std::size_t(i)), estimate);
    });
    in_.jobs.For(std::int64_t(in_.bsp.drawSurfaces.size()), [&](std::int64_t i, int) {
        if (!bright.Empty() && IsLitAtVertices(in_, surfaces, std::size_t(i)))
            ForVertexReceivers(in_, surfaces, std::size_t(i), [&](int vertex, const Vec3f &position) {
                const auto v = std::size_t(vertex);
                const Vec3f &normal = surfaces.verts[v].normal;
                radiosity.brightOnVertices[v] = bright.IrradianceAt(position, gather_.VertexRayOrigin(position, normal),
                                                                    normal, in_.table[std::size_t(i)].shader->twoSided);
            });
    });
}

std::vector<Vec3f> Bounces::BrightOnEmitters(const SurfaceLight &surfaces, const StyleRadiosity &radiosity) const {
    std::vector<Vec3f> light(emitters_.Count());
    for (std::size_t i = 0; i < surfaces.lightmaps.size(); ++i) {
        const std::vector<Vec3f> &luxels = radiosity.brightOnLuxels[i].irradiance;
        const auto texels =
            LuxelMeans(surfaces.lightmaps[i], Vec3f{}, [&](std::size_t luxel) { return luxels[luxel]; });
        std::copy(texels.begin(), texels.end(), light.begin() + emitters_.FirstOf(i));
    }
    std::copy(radiosity.brightOnVertices.begin(), radiosity.brightOnVertices.end(),
              light.begin() + emitters_.Vertex(0));
    return light;
}

bool Bounces::Solve(const SurfaceLight &surfaces) {
    const RadiositySolver solver(in_, surfaces, emitters_, scene_, gather_);
    const RadiosityLimits limits{.bounces = in_.lightmap.bounces, .seconds = in_.lightmap.bounceTime};
    for (const std::uint8_t style : UsedStyles(surfaces)) {
        Emission first = FirstBounce(surfaces, style);
        if (std::all_of(first.begin(), first.end(), [](const Vec3f &one) { return one == Vec3f{}; }))
            continue;
        if (style != 0)
            in_.log.Print("Light style {}\n", style);
        StyleRadiosity &radiosity = byStyle_[style];
        radiosity.bright = std::make_unique<const BrightEmitters>(in_, surfaces, scene_, emitters_, patches_.get(),
                                                                  BrightLimit(first), first);
        in_.log.Count((long long)(radiosity.bright->Patches()), "bright patches");
        GatherBright(surfaces, in_.lightmap.deluxe && style == 0, radiosity);
        const auto received = limits.bounces > 1 ? BrightOnEmitters(surfaces, radiosity) : std::vector<Vec3f>{};
        RadiositySolution solution = solver.Solve(std::move(first), received, limits);
        if (solution.timedOut)
            in_.log.Warn("time for bounces",
                         "-bouncetime {:g} is over after {} bounces; up to {:.2f} bytes of light are "
                         "left out",
                         limits.seconds, solution.steps + 1, solution.stillToCome);
        radiosity.total = std::move(solution.total);
    }
    return !byStyle_.empty();
}

std::unique_ptr<IndirectLight> Bounces::ForPoints() const {
    const auto radiosity = byStyle_.find(0);
    if (radiosity == byStyle_.end())
        return nullptr;
    const int rays = in_.lightmap.bounceRays ? std::max(1, *in_.lightmap.bounceRays * 3 / 2) : BouncedLight::kRays;
    return std::make_unique<BouncedLight>(scene_, radiosity->second.total, *radiosity->second.bright, rays);
}

Vec3f Bounces::IrradianceAt(const Vec3f &position, const Vec3f &normal, bool twoSided) const {
    const auto radiosity = byStyle_.find(0);
    if (radiosity == byStyle_.end())
        return {};
    const Vec3f origin = gather_.VertexRayOrigin(position, normal);
    return radiosity->second.bright->IrradianceAt(position, origin, normal, twoSided) +
           gather_.IrradianceAt(position, normal, twoSided, radiosity->second.total);
}

void Bounces::AddToLuxels(SurfaceLight &surfaces) const {
    in_.jobs.For(std::int64_t(surfaces.lightmaps.size()), [&](std::int64_t number, int) {
        const auto i = std::size_t(number);
        RawLightmap &raw = surfaces.lightmaps[i];
        for (const auto &[style, radiosity] : byStyle_) {
            const std::size_t slot = ClaimSlot(raw.styles, style);
            if (slot >= kStyles)
                continue;
            BounceEstimate found = radiosity.brightOnLuxels[i];
            gather_.AddToLuxels(radiosity.total, i, raw, found);
            AddEstimate(found, slot, raw);
        }
    });
}

void Bounces::AddToVertices(SurfaceLight &surfaces) const {
    VertexLight &vertex = surfaces.vertex;
    // Before the jobs: all surfaces share the vectors of a slot.
    for (const auto &[style, radiosity] : byStyle_)
        for (std::size_t i = 0; i < in_.bsp.drawSurfaces.size(); ++i)
            if (surfaces.lightmapOf[i] < 0)
                if (const std::size_t slot = ClaimSlot(vertex.styles[i], style); slot < kStyles)
                    vertex.sum[slot].resize(surfaces.verts.size());
    in_.jobs.For(std::int64_t(in_.bsp.drawSurfaces.size()), [&](std::int64_t number, int) {
        const auto i = std::size_t(number);
        if (!IsLitAtVertices(in_, surfaces, i))
            return;
        for (const auto &ofStyle : byStyle_) {
            const auto &radiosity = ofStyle.second;
            const std::size_t slot = FindStyleSlot(vertex.styles[i], ofStyle.first);
            if (slot >= kStyles)
                continue;
            ForVertexReceivers(in_, surfaces, i, [&](int drawVert, const Vec3f &position) {
                const auto v = std::size_t(drawVert);
                vertex.sum[slot][v] += radiosity.brightOnVertices[v] +
                                       gather_.IrradianceAt(position, surfaces.verts[v].normal,
                                                            in_.table[i].shader->twoSided, radiosity.total);
            });
        }
    });
}

} // namespace q3
