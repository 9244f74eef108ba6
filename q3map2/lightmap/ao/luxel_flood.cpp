// GPL-2.0-or-later. Floodlight: light from the open part of the hemisphere over a receiver.
#include "q3map2/lightmap/ao/luxel_flood.h"

#include "q3map2/lightmap/ao/ambient_occlusion.h"

namespace q3 {

namespace {

/// Floodlight that the shader of a raw lightmap's first surface asks for, in addition to the world's.
FloodSource ShaderFlood(const SurfaceInputs &in, const RawLightmap &raw) {
    if (raw.surfaces.empty())
        return {};
    const LightmapDirectives &shader = in.table[std::size_t(raw.surfaces.front())].shader->lightmap;
    return {shader.floodColor * shader.floodIntensity, std::max(1.0f, shader.floodDistance)};
}

/// Adds the directional channels of floodlight `light` at a block of receivers, ray by ray. The light of a ray is
/// visibility / cosine, so that it gives its share of `light` on the receiver's normal.
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

float DirectionScale(const SurfaceInputs &in, const RawLightmap &raw) {
    const bool own = ShaderFlood(in, raw).light != Vec3f{};
    const float scale = own ? in.table[std::size_t(raw.surfaces.front())].shader->lightmap.floodDirectionScale
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
                    useRay = [&](const Lanes3 &direction, const Lanes &open) { channels.Add(direction, open); };
                occlusion.SkyVisibility(blocks[b], source.distance, skyVisibility, counts[worker], useRay);
                for (std::size_t i = 0; i < blocks[b].count; ++i)
                    raw.floodlight[luxels[b][i]] += source.light * skyVisibility[i];
            }
        }
    };
    ForMappedLuxelBatches(in, surfaces, wants, addFlood);
    if (const std::uint64_t rays = TotalRays(counts); rays > 0)
        in.log.Count((long long)(rays), "rays of floodlight");
}

} // namespace q3
