// GPL-2.0-or-later. Dirt: luxels in corners and crevices get less light.
#include "q3map2/lightmap/surroundings.h"

namespace q3 {

namespace {

/// Every value becomes the mean of itself and its mapped neighbours that have any, in place and row by row: later
/// luxels see what earlier ones became. That is how dirt is known to look.
void SmoothDirt(RawLightmap &raw) {
    const int width = raw.SuperWidth(), height = raw.SuperHeight();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            float sum = 0, count = 0;
            for (int ny = std::max(0, y - 1); ny <= std::min(height - 1, y + 1); ++ny)
                for (int nx = std::max(0, x - 1); nx <= std::min(width - 1, x + 1); ++nx) {
                    const std::size_t neighbour = raw.SuperIndex(nx, ny);
                    const bool self = nx == x && ny == y;
                    if (self || (raw.Mapped(neighbour) && raw.dirt[neighbour] > 0))
                        sum += raw.dirt[neighbour], count += 1;
                }
            raw.dirt[raw.SuperIndex(x, y)] = sum / count;
        }
}

} // namespace

void DirtLuxels(const SurfaceInputs &in, SurfaceLight &surfaces) {
    if (!in.lightmap.dirty)
        return;
    for (RawLightmap &raw : surfaces.lightmaps)
        raw.dirt.assign(raw.codes.size(), raw.noDirt ? 1.0f : 0.0f);
    const Surroundings around(in);
    std::vector<RayCounts> counts(std::size_t(in.jobs.Threads()));
    ForMappedLuxels(
        in, surfaces, [](const RawLightmap &raw) { return !raw.noDirt; },
        [&](RawLightmap &raw, std::span<const OpenPlaces> blocks, std::span<const LuxelNumbers> luxels,
            std::size_t worker) {
            std::vector<Lanes> dirt;
            around.Dirt(blocks, dirt, counts[worker]);
            for (std::size_t b = 0; b < blocks.size(); ++b)
                for (std::size_t i = 0; i < blocks[b].count; ++i)
                    raw.dirt[luxels[b][i]] = dirt[b][i];
        });
    in.jobs.For(std::int64_t(surfaces.lightmaps.size()), [&](std::int64_t i, int) {
        if (RawLightmap &raw = surfaces.lightmaps[std::size_t(i)]; !raw.noDirt)
            SmoothDirt(raw);
    });
    std::uint64_t rays = 0;
    for (const RayCounts &one : counts)
        rays += one.rays;
    in.log.Count((long long)(rays), "rays of dirt");
}

} // namespace q3
