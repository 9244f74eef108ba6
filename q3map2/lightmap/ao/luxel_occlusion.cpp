// GPL-2.0-or-later. Occlusion of luxels: -dirty, floodlight, and the outputs of -lightmass.
#include "q3map2/lightmap/ao/luxel_occlusion.h"

#include "q3map2/lightmap/ao/ambient_occlusion.h"
#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

// ---- -dirty: ambient occlusion of luxels ----

namespace {

/// Blur of 3 x 3 luxels over mapped ones with dirt above 0, in place and row by row as in NetRadiant's q3map2: a
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
            float &factor = counted[at(x, y)];
            float sum = 0, count = factor > 0 ? 0 : 1; // a luxel itself always counts
            for (const std::size_t first : {y * row + x, (y + 1) * row + x, (y + 2) * row + x})
                for (std::size_t i = first; i < first + 3; ++i)
                    sum += counted[i], count += counted[i] > 0 ? 1.0f : 0.0f;
            const std::size_t luxel = y * width + x;
            raw.dirt[luxel] = sum / count;
            if (raw.Mapped(luxel))
                factor = raw.dirt[luxel];
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
    in.log.Count(TotalRays(counts), "rays of dirt");
}

// ---- Floodlight: light from the open part of the hemisphere over a receiver ----

namespace {

/// Floodlight that the shader of a raw lightmap's first surface asks for, in addition to the world's.
FloodSource ShaderFlood(const SurfaceInputs &in, const RawLightmap &raw) {
    if (raw.surfaces.empty())
        return {};
    const LightmapDirectives &shader = in.table[std::size_t(raw.surfaces.front())].shader->lightmap;
    return {shader.floodColor * shader.floodIntensity, std::max(1.0f, shader.floodDistance)};
}

/// Adds the directional channels of floodlight `light` at a block of receivers, ray by ray. The light of a ray is
/// visibility / cosine, so that it gives its fraction of `light` on the receiver's normal.
class FloodChannels {
  public:
    FloodChannels(RawLightmap &raw, const Vec3f &light, const LuxelIndices &luxels, std::size_t count)
        : raw_(raw), light_(light), luxels_(luxels), count_(count) {
        for (std::size_t i = 0; raw.channels.basis && i < count; ++i)
            basis_[i] = raw.BasisOf(luxels[i]);
    }
    void Add(const Lanes3 &direction, const Lanes &visibility) {
        for (std::size_t i = 0; i < count_; ++i) {
            const float facing = Dot(direction[i], raw_.normals[luxels_[i]]);
            const ChannelWeights weights =
                WeightsOf(direction[i], raw_.channels, raw_.channels.basis ? &basis_[i] : nullptr);
            for (std::size_t c = 0; c < raw_.channels.Count() && facing > 0; ++c)
                raw_.floodChannels[c][luxels_[i]] += light_ * (visibility[i] / facing * weights[c]);
        }
    }

  private:
    RawLightmap &raw_;
    const Vec3f light_;
    const LuxelIndices &luxels_;
    const std::size_t count_;
    std::array<BasisNormals, kPacketSize> basis_;
};

/// Weight of floodlight in the directions of deluxe pages: of the shader if it asks for floodlight, else of the world.
float DirectionScale(const SurfaceInputs &in, const RawLightmap &raw) {
    const bool byShader = ShaderFlood(in, raw).light != Vec3f{};
    const float scale = byShader ? in.table[std::size_t(raw.surfaces.front())].shader->lightmap.floodDirectionScale
                                 : in.world.floodDirectionScale;
    return scale < 0 ? 1 : scale;
}

} // namespace

FloodSource WorldFlood(const SurfaceInputs &in) {
    if (!in.options.floodlight && !in.world.hasFloodlight)
        return {};
    return {in.world.floodColor * in.world.floodIntensity, in.world.floodDistance};
}

void FloodLuxels(const SurfaceInputs &in, SurfaceLight &surfaces) {
    const FloodSource world = WorldFlood(in);
    const auto wants = [&](const RawLightmap &raw) {
        return world.light != Vec3f{} || ShaderFlood(in, raw).light != Vec3f{};
    };
    for (RawLightmap &raw : surfaces.lightmaps)
        if (wants(raw)) {
            raw.floodlight.assign(raw.luxelClusters.size(), {});
            raw.floodChannels.assign(raw.channels.Count(), std::vector<Vec3f>(raw.luxelClusters.size()));
            raw.floodDirectionScale = DirectionScale(in, raw);
        }
    const AmbientOcclusion occlusion(in);
    std::vector<RayCounts> counts(std::size_t(in.jobs.Threads()));
    const auto addFlood = [&](RawLightmap &raw, std::span<const OcclusionReceivers> blocks,
                              std::span<const LuxelIndices> luxels, std::size_t worker) {
        for (const FloodSource &source : {world, ShaderFlood(in, raw)}) {
            for (std::size_t b = 0; b < blocks.size() && source.light != Vec3f{}; ++b) {
                Lanes skyVisibility;
                FloodChannels channels(raw, source.light, luxels[b], blocks[b].count);
                AmbientOcclusion::UseSkyRay useRay;
                if (raw.channels.Any())
                    useRay = [&](const Lanes3 &direction, const Lanes &visibility) {
                        channels.Add(direction, visibility);
                    };
                occlusion.SkyVisibility(blocks[b], source.distance, skyVisibility, counts[worker], useRay);
                for (std::size_t i = 0; i < blocks[b].count; ++i)
                    raw.floodlight[luxels[b][i]] += source.light * skyVisibility[i];
            }
        }
    };
    ForMappedLuxelBatches(in, surfaces, wants, addFlood);
    if (const std::uint64_t rays = TotalRays(counts); rays > 0)
        in.log.Count(rays, "rays of floodlight");
}

// ---- Ambient occlusion and sky occlusion of luxels as outputs of -lightmass ----

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
    in.log.Count(TotalRays(counts), "rays of sky occlusion");
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
