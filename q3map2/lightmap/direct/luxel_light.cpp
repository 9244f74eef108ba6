// GPL-2.0-or-later. Direct light on luxels.
#include "q3map2/lightmap/direct/luxel_light.h"

#include "common/progress.h"
#include "libs/math/color.h"
#include "q3map2/lightmap/direct/debug_view.h"
#include "q3map2/lightmap/direct/luxel_blur.h"
#include "q3map2/lightmap/direct/luxel_lists.h"
#include "q3map2/lightmap/direct/luxel_samples.h"
#include "q3map2/lightmap/raw/style_choice.h"

#include <algorithm>
#include <atomic>
#include <numeric>

namespace q3 {

namespace {

/// Of area lights that give every luxel of a block less than this, only some are traced, with more weight. Byte scale.
constexpr float kFaint = 1.0f / 16;

Q3_VECTOR void AddLanes(const Lanes3 &what, float sign, Lanes3 &sum) {
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        sum.x[i] += what.x[i] * sign;
        sum.y[i] += what.y[i] * sign;
        sum.z[i] += what.z[i] * sign;
    }
}

/// Memory that a worker keeps from lightmap to lightmap.
struct Worker {
    LuxelBlocks blocks;
    LuxelSums sums;
    LuxelSampler sampler;
    LuxelLightList list;
    std::vector<std::uint32_t> reachedBlocks;
    ContributionCounts counts;
};

/// Lights one raw lightmap.
class LightmapPass {
  public:
    /// Puts light that is to be blurred into `unblurred`.
    LightmapPass(const SurfaceInputs &in, const LightsByCluster &lights, const SurfacePass &pass, bool blurAll,
                 RawLightmap &lightmap, std::vector<UnblurredLight> &unblurred, Worker &worker)
        : in_(in), lights_(lights), lightmap_(lightmap), worker_(worker), blurAll_(blurAll), unblurred_(unblurred) {
        pass_.bounce = pass.bounce;
        pass_.deluxe = in.lightmap.deluxe;
        pass_.channels = lightmap.channels;
        pass_.settings = {.sunOnly = in.options.sunOnly,
                          .pointAreas = in.lightmap.faster,
                          .halfLambert = in.lightmap.halfLambert,
                          .receiveShadows = lightmap.receiveShadows,
                          .faint = in.options.skip.faint ? kFaint : 0,
                          .directional = lightmap.channels.Any()};
        sampling_ = in.lightmap.samples > 1 || in.lightmap.randomSamples;
    }

    /// Names of lights that found no place.
    std::vector<std::string> Dropped() const { return styles_.Names(); }

    void Run() {
        worker_.blocks.Build(lightmap_);
        worker_.sums.Clear();
        worker_.sums.deluxe = pass_.deluxe;
        worker_.sums.directional = pass_.channels.Any();
        Clear();
        if (worker_.blocks.Count() == 0)
            return;
        if (in_.lightmap.show != DebugView::Light) {
            DrawDebugView(in_.lightmap.show, lightmap_);
            return;
        }
        if (sampling_)
            worker_.sampler.Start(in_, lightmap_, worker_.blocks, pass_);
        worker_.list.Build(lights_, lightmap_, in_.options.sunOnly);
        if (StyleChoice::IsNeeded(worker_.list.Lights()))
            ChooseStyles();
        for (const Light *light : worker_.list.Lights())
            AddLight(*light);
        for (std::size_t i = 0; i < worker_.sums.used; ++i)
            AddSum(worker_.sums.sums[i]);
    }

  private:
    /// Sets mapped luxels to ambient light in slot 0 and to zero in others.
    void Clear() {
        const std::size_t count = lightmap_.luxelClusters.size();
        const Vec3f ambient = pass_.bounce ? Vec3f{} : lightmap_.ambient;
        for (std::size_t slot = 0; slot < kStyles; ++slot)
            if (slot == 0 || !lightmap_.light[slot].empty())
                ClearStyleSlot(lightmap_, slot, slot == 0 ? ambient : Vec3f{});
        if (!pass_.deluxe)
            return;
        const float share = std::max(1.0f / 256, Luminance(ambient) / 255);
        lightmap_.directions.assign(count, {});
        for (std::size_t i = 0; i < count; ++i)
            if (lightmap_.Mapped(i))
                lightmap_.directions[i] = lightmap_.normals[i] * share;
    }

    /// The sum that the light adds to. Claims the slot for a new style.
    LuxelSum &SumFor(const Light &light, std::size_t slot) {
        if (lightmap_.light[slot].empty())
            ClearStyleSlot(lightmap_, slot, {});
        lightmap_.styles[slot] = std::uint8_t(light.style);
        return worker_.sums.FindOrAdd(slot, std::max(0.0f, light.filterRadius), worker_.blocks.Count());
    }

    void AddLight(const Light &light) {
        const std::size_t slot = StyleSlotFor(lightmap_.styles, light.style);
        if (slot == kStyles || styles_.Drops(light.style))
            return;
        worker_.reachedBlocks.clear();
        worker_.blocks.FindReached(light, pass_.settings, worker_.reachedBlocks);
        if (sampling_)
            worker_.sampler.StartLight(light);
        LuxelSum *sum = nullptr;
        const float sign = light.negative ? -1.0f : 1.0f;
        LuxelIncidentLight incident;
        ChannelLanes channels;
        for (const std::uint32_t block : worker_.reachedBlocks) {
            if (!Contribution(light, block, incident, channels))
                continue;
            if (!sum)
                sum = &SumFor(light, slot);
            AddLanes(incident.color, sign, sum->color[block]);
            if (pass_.deluxe)
                AddLanes(incident.direction, 1, sum->direction[block]);
            for (std::size_t c = 0; c < pass_.channels.Count(); ++c)
                AddLanes(channels[c], sign, sum->channels[block][c]);
            if (sampling_)
                worker_.sampler.SetBlock(block, incident, channels);
        }
        if (sampling_ && sum)
            worker_.sampler.Refine(*sum, worker_.counts);
    }

    bool Contribution(const Light &light, std::size_t block, LuxelIncidentLight &incident, ChannelLanes &channels) {
        const LuxelReceivers receivers{worker_.blocks.Receivers(block), worker_.blocks.Basis(block)};
        return LuxelContribution(light, pass_, in_.scene, receivers, incident, channels, worker_.counts);
    }

    /// Measures the light of all styles to find those to drop.
    void ChooseStyles() {
        LuxelIncidentLight incident;
        ChannelLanes channels;
        for (const Light *light : worker_.list.Lights()) {
            double energy = 0;
            worker_.reachedBlocks.clear();
            if (light->style != 0)
                worker_.blocks.FindReached(*light, pass_.settings, worker_.reachedBlocks);
            for (const std::uint32_t block : worker_.reachedBlocks)
                if (Contribution(*light, block, incident, channels))
                    for (std::size_t i = 0; i < worker_.blocks.Receivers(block).count; ++i)
                        energy +=
                            double(incident.color.x[i]) + double(incident.color.y[i]) + double(incident.color.z[i]);
            styles_.Add(*light, energy);
        }
        styles_.Choose();
    }

    /// Adds a sum to luxels. lanesOf(block): the sum of a block.
    template <typename LanesOf> void AddDense(const LanesOf &lanesOf, std::vector<Vec3f> &to) const {
        for (std::size_t block = 0; block < worker_.blocks.Count(); ++block) {
            const auto &luxels = worker_.blocks.Luxels(block);
            const Lanes3 &lanes = lanesOf(block);
            for (std::size_t i = 0; i < worker_.blocks.Receivers(block).count; ++i)
                to[luxels[i]] += lanes[i];
        }
    }

    void AddDense(const LuxelSum &sum, std::vector<Vec3f> &light, std::vector<Vec3f> &directions,
                  ChannelImages &channels) const {
        AddDense([&](std::size_t block) -> const Lanes3 & { return sum.color[block]; }, light);
        if (pass_.deluxe)
            AddDense([&](std::size_t block) -> const Lanes3 & { return sum.direction[block]; }, directions);
        for (std::size_t c = 0; c < pass_.channels.Count(); ++c)
            AddDense([&](std::size_t block) -> const Lanes3 & { return sum.channels[block][c]; }, channels[c]);
    }

    /// Adds a sum to the lightmap, or keeps it until those of all lightmaps are known, if it is to be blurred.
    void AddSum(const LuxelSum &sum) {
        if (!blurAll_ && sum.filterRadius == 0)
            return AddDense(sum, lightmap_.light[sum.slot], lightmap_.directions, lightmap_.directional[sum.slot]);
        const std::vector<Vec3f> zero(lightmap_.luxelClusters.size());
        UnblurredLight &kept = unblurred_.emplace_back();
        kept.style = lightmap_.styles[sum.slot], kept.filterRadius = sum.filterRadius;
        kept.color = zero;
        if (pass_.deluxe)
            kept.direction = zero;
        kept.channels.assign(pass_.channels.Count(), zero);
        AddDense(sum, kept.color, kept.direction, kept.channels);
    }

    const SurfaceInputs &in_;
    const LightsByCluster &lights_;
    RawLightmap &lightmap_;
    Worker &worker_;
    LuxelPass pass_;
    StyleChoice styles_;
    bool sampling_ = false;
    const bool blurAll_; // not only light of sources with a filter radius
    std::vector<UnblurredLight> &unblurred_;
};

} // namespace

void LightLuxels(const SurfaceInputs &in, const std::vector<Light> &lights, const SurfacePass &pass,
                 SurfaceLight &surfaces, ContributionCounts &counts) {
    const LightsByCluster lists(lights, true);
    // The largest first, so that all workers finish at about the same time.
    std::vector<std::size_t> order(surfaces.lightmaps.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return surfaces.lightmaps[a].luxelClusters.size() > surfaces.lightmaps[b].luxelClusters.size();
    });
    std::vector<Worker> workers(std::size_t(in.jobs.Threads()));
    DroppedLights dropped(surfaces.lightmaps.size());
    const bool blurAll = BlursAllLight(in, surfaces);
    UnblurredLights unblurred(surfaces.lightmaps.size());
    std::atomic<std::uint64_t> raysSoFar{0};
    Progress progress(in.log, std::int64_t(order.size()));
    in.jobs.For(
        std::int64_t(order.size()),
        [&](std::int64_t index, int number) {
            Worker &worker = workers[std::size_t(number)];
            const std::uint64_t before = worker.counts.rays;
            const std::size_t lightmap = order[std::size_t(index)];
            LightmapPass one(in, lists, pass, blurAll, surfaces.lightmaps[lightmap], unblurred[lightmap], worker);
            one.Run();
            dropped[lightmap] = one.Dropped();
            raysSoFar += worker.counts.rays - before;
        },
        [&](std::int64_t done) { progress.Update(done, raysSoFar); });
    progress.Finish();
    AddBlurredLight(in, unblurred, surfaces);
    for (const Worker &worker : workers)
        counts += worker.counts;
    WarnOfDroppedLights(dropped, "light", "lightmaps", in.log);
}

} // namespace q3
