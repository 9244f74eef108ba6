// GPL-2.0-or-later. Ambient occlusion and sky occlusion of luxels as outputs of -lightmass.
#include "q3map2/lightmap/ao/luxel_occlusion.h"

#include "q3map2/lightmap/ao/ambient_occlusion.h"
#include "q3map2/lightmap/raw/luxel_means.h"

namespace q3 {

namespace {

/// Results of AmbientOcclusion::OpenSky: [raw lightmap][super luxel].
using SkyDirections = std::vector<std::vector<Vec3f>>;

SkyDirections FindSkyDirections(const SurfaceInputs &in, SurfaceLight &surfaces) {
    SkyDirections sky(surfaces.lightmaps.size());
    for (std::size_t i = 0; i < sky.size(); ++i)
        sky[i].resize(surfaces.lightmaps[i].luxelClusters.size());
    const AmbientOcclusion occlusion(in);
    std::vector<RayCounts> counts(std::size_t(in.jobs.Threads()));
    const auto trace = [&](RawLightmap &raw, std::span<const OcclusionReceivers> blocks,
                           std::span<const LuxelIndices> luxels, std::size_t worker) {
        std::vector<Vec3f> &directions = sky[std::size_t(&raw - surfaces.lightmaps.data())];
        for (std::size_t b = 0; b < blocks.size(); ++b) {
            Lanes3 found;
            occlusion.OpenSky(blocks[b], found, counts[worker]);
            for (std::size_t i = 0; i < blocks[b].count; ++i)
                directions[luxels[b][i]] = found[i];
        }
    };
    ForMappedLuxelBatches(
        in, surfaces, [](const RawLightmap &) { return true; }, trace);
    in.log.Count((long long)(TotalRays(counts)), "rays of sky occlusion");
    return sky;
}

} // namespace

void FindOcclusion(const SurfaceInputs &in, SurfaceLight &surfaces) {
    for (RawLightmap &raw : surfaces.lightmaps)
        if (!raw.dirt.empty())
            raw.unoccluded = LuxelMeans(raw, 0.0f, [&](std::size_t at) { return raw.dirt[at]; });
    if (!in.lightmap.skyOcclusion)
        return;
    const SkyDirections sky = FindSkyDirections(in, surfaces);
    for (std::size_t i = 0; i < sky.size(); ++i)
        surfaces.lightmaps[i].skyOcclusion =
            LuxelMeans(surfaces.lightmaps[i], Vec3f{}, [&](std::size_t at) { return sky[i][at]; });
}

} // namespace q3
