// GPL-2.0-or-later. -dirty: ambient occlusion of luxels.
#include "q3map2/lightmap/ao/luxel_dirt.h"

#include "q3map2/lightmap/ao/ambient_occlusion.h"

namespace q3 {

namespace {

/// Blur of 3 x 3 luxels over mapped ones with dirt above 0, in place and row by row as in the established program: a
/// luxel averages values that are already blurred above and to the left of it.
void SmoothDirt(RawLightmap &raw) {
    const auto width = std::size_t(raw.SuperWidth()), height = std::size_t(raw.SuperHeight()), row = width + 2;
    std::vector<float> counted(row * (height + 2)); // with a border; 0: does not count as a neighbor
    const auto at = [&](std::size_t x, std::size_t y) { return (y + 1) * row + x + 1; };
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x)
            if (const std::size_t luxel = y * width + x; raw.Mapped(luxel))
                counted[at(x, y)] = raw.dirt[luxel];
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x) {
            float &own = counted[at(x, y)];
            float sum = 0, count = own > 0 ? 0 : 1; // a luxel itself always counts
            for (const std::size_t first : {y * row + x, (y + 1) * row + x, (y + 2) * row + x})
                for (std::size_t i = first; i < first + 3; ++i)
                    sum += counted[i], count += counted[i] > 0 ? 1.0f : 0.0f;
            const std::size_t luxel = y * width + x;
            raw.dirt[luxel] = sum / count;
            if (raw.Mapped(luxel))
                own = raw.dirt[luxel];
        }
}

} // namespace

void DirtLuxels(const SurfaceInputs &in, SurfaceLight &surfaces) {
    if (!in.lightmap.dirty)
        return;
    for (RawLightmap &raw : surfaces.lightmaps)
        raw.dirt.assign(raw.luxelClusters.size(), raw.noDirt ? 1.0f : 0.0f);
    const AmbientOcclusion occlusion(in);
    std::vector<RayCounts> counts(std::size_t(in.jobs.Threads()));
    ForMappedLuxelBatches(
        in, surfaces, [](const RawLightmap &raw) { return !raw.noDirt; },
        [&](RawLightmap &raw, std::span<const OcclusionReceivers> blocks, std::span<const LuxelIndices> luxels,
            std::size_t worker) {
            std::vector<Lanes> dirt;
            occlusion.Dirt(blocks, dirt, counts[worker]);
            for (std::size_t b = 0; b < blocks.size(); ++b)
                for (std::size_t i = 0; i < blocks[b].count; ++i)
                    raw.dirt[luxels[b][i]] = dirt[b][i];
        });
    in.jobs.For(std::int64_t(surfaces.lightmaps.size()), [&](std::int64_t i, int) {
        if (RawLightmap &raw = surfaces.lightmaps[std::size_t(i)]; !raw.noDirt)
            SmoothDirt(raw);
    });
    in.log.Count((long long)(TotalRays(counts)), "rays of dirt");
}

} // namespace q3
