// GPL-2.0-or-later. The passes of the light stage over the luxels of a map, kept for measuring.
#include "tools/measure/directional_error/luxel_bake.h"

#include "q3map2/light/sources/light_sources.h"

#include <algorithm>

namespace q3::directional {

LuxelBake::LuxelBake(const LightSetup &setup, const LightmapOptions &options, const JobPool &jobs, Log &log)
    : scene_(setup.scene), passes_(setup, options, jobs, log, {.floodlight = false, .keepLuxels = true}) {
    passes_.Run();
    cpuSeconds_ = timer_.Seconds();
    bounced_ = passes_.ForGrids().steady;
    int culled = 0;
    lights_ = SetupEnvelopes(setup.lights, LightPass::Surfaces, setup.options, setup.space, setup.skySeenFrom, culled,
                             options.fastPoint);
}

std::vector<Vec3f> LuxelBake::LightOn(const LuxelPlace &at, std::span<const Vec3f> normals, int rays) const {
    std::vector<Vec3f> light(normals.size(), Lightmap(at).ambient);
    AddDirect(at, normals, light);
    if (bounced_ && rays > 0)
        AddBounced(at, normals, rays, light);
    return light;
}

void LuxelBake::AddDirect(const LuxelPlace &at, std::span<const Vec3f> normals, std::span<Vec3f> light) const {
    const RawLightmap &raw = Lightmap(at);
    const Vec3f normal = raw.normals[at.luxel];
    const SurfaceLightSettings settings{.receiveShadows = raw.receiveShadows};
    ContributionCounts counts;
    SurfaceIncidentLight incident;
    for (std::size_t first = 0; first < normals.size(); first += kPacketSize) {
        SurfaceReceiverBatch receivers;
        for (std::size_t i = first; i < std::min(normals.size(), first + kPacketSize); ++i)
            receivers.Add(raw.positions[at.luxel], normals[i], raw.luxelClusters[at.luxel]);
        for (const Light &one : lights_) {
            if (one.style != 0)
                continue;
            LightContributionToSample(one, settings, scene_, receivers, incident, counts);
            for (std::size_t i = 0; i < receivers.count; ++i)
                if (incident.live[i] != 0 && Dot(incident.direction[i], normal) > 0) {
                    const Vec3f color = one.color * (one.negative ? -incident.strength[i] : incident.strength[i]);
                    light[first + i] += incident.tinted ? color * incident.tint[i] : color;
                }
        }
    }
}

void LuxelBake::AddBounced(const LuxelPlace &at, std::span<const Vec3f> normals, int rays,
                           std::span<Vec3f> light) const {
    const RawLightmap &raw = Lightmap(at);
    const Vec3f normal = raw.normals[at.luxel];
    std::vector<IndirectRay> found;
    std::vector<Vec3f> sums(normals.size());
    const Vec3f &origin = raw.positions[at.luxel];
    constexpr std::uint64_t kSeedStride = 977; // from pattern to pattern of a luxel; a prime, chosen
    const int patterns = (rays + PointGather::kRays - 1) / PointGather::kRays;
    for (int pattern = 0; pattern < patterns; ++pattern) {
        bounced_->Gather(origin, std::uint64_t(pattern) * kSeedStride + at.luxel, found);
        for (const IndirectRay &ray : found)
            if (Dot(ray.direction, normal) > 0) // the rest hits the surface itself
                for (std::size_t i = 0; i < normals.size(); ++i)
                    sums[i] += ray.light * std::max(0.0f, Dot(ray.direction, normals[i]));
    }
    for (std::size_t i = 0; i < normals.size(); ++i)
        light[i] += sums[i] / float(patterns);
}

std::vector<LuxelPlace> LuxelBake::Sample(std::size_t count) const {
    constexpr float kLeastLight = 1; // byte scale
    std::vector<LuxelPlace> lit;
    for (std::size_t m = 0; m < Surfaces().lightmaps.size(); ++m) {
        const RawLightmap &raw = Surfaces().lightmaps[m];
        for (std::size_t i = 0; i < raw.luxelClusters.size() && !raw.result[0].empty(); ++i)
            if (raw.Mapped(i) && MaxComponent(raw.result[0][i]) >= kLeastLight)
                lit.push_back({m, i});
    }
    std::vector<LuxelPlace> sample;
    for (std::size_t i = 0; i < std::min(count, lit.size()); ++i)
        sample.push_back(lit[(2 * i + 1) * lit.size() / (2 * std::min(count, lit.size()))]);
    return sample;
}

} // namespace q3::directional
