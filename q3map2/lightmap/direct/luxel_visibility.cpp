// GPL-2.0-or-later. Shadow maps: the visibility of named lights at luxels.
#include "q3map2/lightmap/direct/luxel_visibility.h"

#include "libs/math/color.h"
#include "q3map2/lightmap/direct/luxel_blocks.h"
#include "q3map2/lightmap/raw/luxel_means.h"

#include <algorithm>

namespace q3 {

namespace {

/// Light of the named lights at the super luxels of one raw lightmap, with and without shadows.
struct NamedLight {
    std::vector<float> arriving, unshadowed;
};

void AddLight(const Light &light, bool shadows, const SurfaceInputs &in, const RawLightmap &raw, LuxelBlocks &blocks,
              std::vector<float> &sums, ContributionCounts &counts) {
    const SurfaceLightSettings settings{.pointAreas = in.lightmap.faster,
                                        .halfLambert = in.lightmap.halfLambert,
                                        .occlusion = shadows,
                                        .receiveShadows = raw.receiveShadows};
    std::vector<std::uint32_t> reached;
    blocks.FindReached(light, settings, reached);
    SurfaceIncidentLight incident;
    for (const std::uint32_t block : reached) {
        LightContributionToSample(light, settings, in.scene, blocks.Receivers(block), incident, counts);
        for (std::size_t i = 0; i < blocks.Receivers(block).count; ++i)
            if (incident.live[i] != 0)
                sums[blocks.Luxels(block)[i]] +=
                    incident.add[i] * (incident.tinted ? Luminance(incident.tint[i]) / Luminance({1, 1, 1}) : 1);
    }
}

} // namespace

void FindVisibility(const SurfaceInputs &in, const std::vector<Light> &lights, SurfaceLight &surfaces,
                    ContributionCounts &counts) {
    const std::vector<std::string> &names = in.lightmap.shadowMaps;
    for (const std::string &name : names)
        if (std::none_of(lights.begin(), lights.end(), [&](const Light &light) { return light.name == name; }))
            in.log.Warn("shadow map", "-shadowmap {}: no light has this targetname", name);
    std::vector<LuxelBlocks> blocks(std::size_t(in.jobs.Threads()));
    std::vector<ContributionCounts> work(blocks.size());
    in.jobs.For(std::int64_t(surfaces.lightmaps.size()), [&](std::int64_t number, int worker) {
        RawLightmap &raw = surfaces.lightmaps[std::size_t(number)];
        LuxelBlocks &own = blocks[std::size_t(worker)];
        own.Build(raw);
        raw.visibility.resize(names.size());
        for (std::size_t n = 0; n < names.size(); ++n) {
            NamedLight sums{std::vector<float>(raw.luxelClusters.size()), std::vector<float>(raw.luxelClusters.size())};
            for (const Light &light : lights)
                if (light.name == names[n]) {
                    AddLight(light, true, in, raw, own, sums.arriving, work[std::size_t(worker)]);
                    AddLight(light, false, in, raw, own, sums.unshadowed, work[std::size_t(worker)]);
                }
            raw.visibility[n] = LuxelMeans(raw, -1.0f, [&](std::size_t at) {
                return sums.unshadowed[at] > 0 ? std::min(1.0f, sums.arriving[at] / sums.unshadowed[at]) : 0;
            });
        }
    });
    for (const ContributionCounts &one : work)
        counts += one;
}

} // namespace q3
