// GPL-2.0-or-later. Radiosity: bounced light on surfaces.
#include "q3map2/lightmap/bounce/light_bounce.h"

#include "common/text/text.h"
#include "libs/math/vec.h"
#include "q3map2/lightmap/bounce/bounce_filter.h"
#include "q3map2/lightmap/bounce/bounce_gather.h"

#include <algorithm>
#include <functional>
#include <optional>

namespace q3 {

// ---- Assigns style slots of surfaces to bounced light ----

namespace {

/// A style takes no slot of a surface where all its light is below this. Byte scale.
constexpr float kLeastStyleLight = 1.0f / 16;

} // namespace

StyleEnergy EnergyOf(std::span<const Vec3f> light) {
    StyleEnergy energy;
    for (const Vec3f &one : light) {
        energy.sum += double(Luminance(one));
        energy.most = std::max(energy.most, MaxComponent(one));
    }
    return energy;
}

std::size_t ClaimSlot(std::uint8_t style, const StyleEnergy &energy, Styles &styles,
                      std::vector<std::string> &dropped) {
    const std::size_t known = FindStyleSlot(styles, style);
    if (known < kStyles || energy.most < kLeastStyleLight)
        return known;
    const std::size_t slot = FindStyleSlot(styles, kNoStyle);
    if (slot < kStyles)
        styles[slot] = style;
    else
        dropped.push_back(fmt::format("light of style {}", style));
    return slot;
}

// ---- Radiosity: bounced light on surfaces ----

namespace {

/// Emitters are bright if their radiosity is above kBright (byte scale) and above the radiosity of kBrightFraction of
/// all emitters with light.
constexpr float kBright = 16, kBrightFraction = 0.9f;

/// The radiosity above which emitters are bright.
float BrightLimit(const Emission &emission) {
    std::vector<float> lit;
    for (const Vec3f &one : emission)
        if (const float most = MaxComponent(one); most > 0)
            lit.push_back(most);
    if (lit.empty())
        return kBright;
    const auto at = lit.begin() + std::ptrdiff_t(kBrightFraction * float(lit.size() - 1));
    std::nth_element(lit.begin(), at, lit.end());
    return std::max(kBright, *at);
}

void AddVectors(const std::vector<Vec3f> &values, std::vector<Vec3f> &to) {
    to.resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
        to[i] += values[i];
}

/// Adds the estimate to the light of a style slot.
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

std::unique_ptr<const FaintPatches> Bounces::MakePatches(const SurfaceLight &surfaces) const {
    Emission sumOfStyles(emitters_.Count());
    for (const std::uint8_t style : UsedStyles(surfaces)) {
        const Emission one = FirstBounce(surfaces, style);
        for (std::size_t i = 0; i < sumOfStyles.size(); ++i)
            sumOfStyles[i] += one[i];
    }
    return std::make_unique<const FaintPatches>(in_, surfaces, emitters_, sumOfStyles);
}

/// Radiosity summed over bounces. first: radiosity of the first bounce.
Emission Bounces::AllBounces(const RadiositySolver &solver, Emission first) const {
    const RadiosityLimits limits{.bounces = in_.lightmap.bounces, .seconds = in_.lightmap.bounceTime};
    RadiositySolution solution = solver.Solve(std::move(first), limits);
    if (solution.timedOut)
        in_.log.Warn("time for bounces", "-bouncetime {:g} is over after {}; up to {:.2f} levels of light are left out",
                     limits.seconds, Counted(solution.steps + 1, "bounces"), solution.stillToCome);
    return std::move(solution.total);
}

bool Bounces::Solve(const SurfaceLight &surfaces) {
    std::optional<const RadiositySolver> solver;
    for (const std::uint8_t style : UsedStyles(surfaces)) {
        Emission emission = FirstBounce(surfaces, style);
        if (std::all_of(emission.begin(), emission.end(), [](const Vec3f &one) { return one == Vec3f{}; }))
            continue;
        if (style != 0)
            in_.log.Print("Light style {}\n", style);
        if (in_.lightmap.bounces > 1) {
            if (!solver)
                solver.emplace(in_, surfaces, emitters_, scene_, gather_);
            emission = AllBounces(*solver, std::move(emission));
        }
        StyleRadiosity &radiosity = byStyle_[style];
        radiosity.bright = std::make_unique<const BrightEmitters>(in_, surfaces, scene_, emitters_, patches_.get(),
                                                                  BrightLimit(emission), emission);
        in_.log.Count(radiosity.bright->PatchCount(), "bright patches");
        radiosity.rest = std::move(emission);
    }
    return !byStyle_.empty();
}

std::unique_ptr<IndirectLight> Bounces::ForPoints() const {
    const auto radiosity = byStyle_.find(0);
    return radiosity == byStyle_.end() ? nullptr : PointsLitBy(radiosity->second);
}

std::vector<StyledIndirect> Bounces::StyledForPoints() const {
    std::vector<StyledIndirect> styled;
    for (const auto &[style, radiosity] : byStyle_)
        if (style != 0)
            styled.push_back({style, PointsLitBy(radiosity)});
    return styled;
}

std::unique_ptr<IndirectLight> Bounces::PointsLitBy(const StyleRadiosity &radiosity) const {
    // 3 / 2: the ratio of the defaults, 96 rays from a point and 64 from a luxel.
    const int rays = in_.lightmap.bounceRays ? std::max(1, *in_.lightmap.bounceRays * 3 / 2) : PointGather::kRays;
    return std::make_unique<PointGather>(scene_, radiosity.rest, *radiosity.bright, rays);
}

Vec3f Bounces::IrradianceAt(const Vec3f &position, const Vec3f &normal, bool twoSided) const {
    const auto radiosity = byStyle_.find(0);
    if (radiosity == byStyle_.end())
        return {};
    return IrradianceOf(radiosity->second, position, normal, twoSided, VertexSeed(position));
}

Vec3f Bounces::IrradianceOf(const StyleRadiosity &radiosity, const Vec3f &position, const Vec3f &normal, bool twoSided,
                            std::uint64_t seed) const {
    return radiosity.bright->IrradianceAt(position, gather_.VertexRayOrigin(position, normal), normal, twoSided) +
           gather_.IrradianceAt(position, normal, twoSided, radiosity.rest, seed);
}

/// Light by style. All styles share one noise filter, computed from their sum, so that they add up to what the same
/// lights would give in a single style.
std::vector<BouncedStyle<BounceEstimate>> Bounces::LightOnLuxels(std::size_t lightmap, const RawLightmap &raw) const {
    std::vector<BouncedStyle<BounceEstimate>> found;
    std::vector<float> luminance(raw.luxelClusters.size()), difference(luminance.size());
    for (const auto &[style, radiosity] : byStyle_) {
        BounceEstimate estimate(raw, in_.lightmap.deluxe && style == 0);
        gather_.GatherLuxels(radiosity.rest, lightmap, raw, estimate, difference);
        for (std::size_t i = 0; i < luminance.size(); ++i)
            luminance[i] += Luminance(estimate.irradiance[i]);
        found.push_back({style, {}, std::move(estimate)});
    }
    const NoiseFilter filter(raw, luminance, difference);
    for (BouncedStyle<BounceEstimate> &one : found) {
        filter.Apply(one.light);
        if (const BrightEmitters &bright = *byStyle_.at(one.style).bright; !bright.Empty())
            bright.AddToLuxels(raw, gather_.Origins(lightmap), one.light);
        one.energy = EnergyOf(one.light.irradiance);
    }
    return found;
}

void Bounces::AddToLuxels(SurfaceLight &surfaces) const {
    DroppedLights dropped(surfaces.lightmaps.size());
    in_.jobs.For(std::int64_t(surfaces.lightmaps.size()), [&](std::int64_t number, int) {
        const auto i = std::size_t(number);
        RawLightmap &raw = surfaces.lightmaps[i];
        std::vector<BouncedStyle<BounceEstimate>> found = LightOnLuxels(i, raw);
        ClaimSlots(found, raw.styles, dropped[i]);
        for (const BouncedStyle<BounceEstimate> &one : found)
            if (one.slot < kStyles)
                AddEstimate(one.light, one.slot, raw);
    });
    WarnOfDroppedLights(dropped, "bounced light", "lightmaps", in_.log);
}

std::vector<Vec3f> Bounces::LightOnVertices(const SurfaceLight &surfaces, const StyleRadiosity &radiosity,
                                            std::size_t surface) const {
    const bspDrawSurface_t &drawn = in_.bsp.drawSurfaces[surface];
    std::vector<Vec3f> light(std::size_t(drawn.numVerts));
    ForVertexReceivers(in_, surfaces, surface, [&](int vertex, const Vec3f &position) {
        const SurfaceVertex &receiver = surfaces.verts[std::size_t(vertex)];
        light[std::size_t(vertex - drawn.firstVert)] = IrradianceOf(
            radiosity, position, receiver.normal, in_.table[surface].shader->twoSided, VertexSeed(receiver.xyz));
    });
    return light;
}

void Bounces::AddToVertices(SurfaceLight &surfaces) const {
    using VertexStyles = std::vector<BouncedStyle<std::vector<Vec3f>>>;
    std::vector<VertexStyles> found(in_.bsp.drawSurfaces.size());
    DroppedLights dropped(found.size());
    VertexLight &vertex = surfaces.vertex;
    in_.jobs.For(std::int64_t(found.size()), [&](std::int64_t number, int) {
        const auto i = std::size_t(number);
        if (!IsLitAtVertices(in_, surfaces, i))
            return;
        for (const auto &one : byStyle_) {
            std::vector<Vec3f> light = LightOnVertices(surfaces, one.second, i);
            const StyleEnergy energy = EnergyOf(light);
            found[i].push_back({one.first, energy, std::move(light)});
        }
        ClaimSlots(found[i], vertex.styles[i], dropped[i]);
    });
    // After the jobs: all surfaces share the vectors of a slot.
    for (std::size_t i = 0; i < found.size(); ++i)
        for (const auto &one : found[i])
            if (one.slot < kStyles) {
                vertex.sum[one.slot].resize(surfaces.verts.size());
                const auto to = vertex.sum[one.slot].begin() + in_.bsp.drawSurfaces[i].firstVert;
                std::transform(one.light.begin(), one.light.end(), to, to, std::plus());
            }
    WarnOfDroppedLights(dropped, "bounced light", "surfaces lit at vertices", in_.log);
}

} // namespace q3
