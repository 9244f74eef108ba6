// GPL-2.0-or-later. Direct or bounced light on luxels.
#include "q3map2/lightmap/direct/luxel_light.h"

#include "common/progress.h"
#include "libs/math/color.h"
#include "q3map2/lightmap/direct/debug_view.h"
#include "q3map2/lightmap/direct/luxel_lists.h"

#include <algorithm>
#include <atomic>
#include <numeric>

namespace q3 {

namespace {

/// Area lights that give a block of luxels less are represented by a few. Byte scale.
constexpr float kFaint = 1.0f / 16;
/// Directions of bounced light count less.
constexpr float kBounceDirections = 0.25f;

/// colour and direction of what arrives, lane by lane.
Q3_VECTOR void FillArrivals(const Light &light, const SurfaceIncidentLight &from, float directionScale,
                            LuxelIncidentLight &out) {
    const Vec3f c = light.color;
    const std::int32_t colored = c.x + c.y + c.z > 0 ? -1 : 0;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float add = from.live[i] != 0 ? from.add[i] : 0;
        out.color.x[i] = add * c.x, out.color.y[i] = add * c.y, out.color.z[i] = add * c.z;
    }
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        out.lit[i] = from.live[i] & colored;
        out.forced[i] = from.add[i] > 1 ? from.filtered[i] : 0;
    }
    if (from.tinted)
        for (std::size_t i = 0; i < kPacketSize; ++i)
            if (from.live[i] != 0) {
                out.color.x[i] *= from.tint.x[i];
                out.color.y[i] *= from.tint.y[i];
                out.color.z[i] *= from.tint.z[i];
            }
    if (directionScale > 0)
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            const float weight = from.live[i] != 0 && from.undirected[i] == 0 ? from.add[i] * directionScale : 0;
            out.direction.x[i] = weight > 0 ? from.direction.x[i] * weight : 0;
            out.direction.y[i] = weight > 0 ? from.direction.y[i] * weight : 0;
            out.direction.z[i] = weight > 0 ? from.direction.z[i] * weight : 0;
        }
}

Q3_VECTOR void AddLanes(const Lanes3 &what, float sign, Lanes3 &sum) {
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        sum.x[i] += what.x[i] * sign;
        sum.y[i] += what.y[i] * sign;
        sum.z[i] += what.z[i] * sign;
    }
}

/// What one worker keeps from lightmap to lightmap.
struct Worker {
    LuxelBlocks blocks;
    LuxelSums sums;
    LuxelSampler sampler;
    LuxelFilter filter;
    LuxelLightList list;
    std::vector<std::uint32_t> reached;
    std::vector<Vec3f> dense;
    ContributionCounts counts;
};

/// Lights one raw lightmap.
class LightmapPass {
  public:
    LightmapPass(const SurfaceInputs &in, const LightsByCluster &lights, const SurfacePass &pass, RawLightmap &lightmap,
                 Worker &worker)
        : in_(in), lights_(lights), lightmap_(lightmap), worker_(worker) {
        pass_.bounce = pass.bounce;
        pass_.deluxe = in.lightmap.deluxe;
        pass_.settings = {.sunOnly = in.options.sunOnly,
                          .pointAreas = in.lightmap.faster,
                          .halfLambert = in.lightmap.halfLambert,
                          .receiveShadows = lightmap.receiveShadows,
                          .faint = in.options.skip.faint ? kFaint : 0};
        sampling_ = in.lightmap.samples > 1 || in.lightmap.randomSamples;
    }

    void Run() {
        worker_.blocks.Build(lightmap_);
        worker_.sums.Clear();
        worker_.sums.deluxe = pass_.deluxe;
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
        for (const Light *light : worker_.list.Lights())
            AddLight(*light);
        for (std::size_t i = 0; i < worker_.sums.used; ++i)
            AddSum(worker_.sums.sums[i]);
    }

  private:
    /// Ambient light where a luxel is mapped; nothing elsewhere and in other styles.
    void Clear() {
        const std::size_t count = lightmap_.luxelClusters.size();
        const Vec3f ambient = pass_.bounce ? Vec3f{} : lightmap_.ambient;
        for (std::size_t slot = 0; slot < kStyles; ++slot)
            if (slot == 0 || !lightmap_.light[slot].empty())
                ClearSlot(slot, slot == 0 ? ambient : Vec3f{});
        if (!pass_.deluxe)
            return;
        const float share = std::max(1.0f / 256, Luminance(ambient) / 255);
        lightmap_.directions.assign(count, {});
        for (std::size_t i = 0; i < count; ++i)
            if (lightmap_.Mapped(i))
                lightmap_.directions[i] = lightmap_.normals[i] * share;
    }

    void ClearSlot(std::size_t slot, const Vec3f &value) {
        const std::size_t count = lightmap_.luxelClusters.size();
        lightmap_.light[slot].assign(count, {});
        lightmap_.filled[slot].assign(count, 0);
        for (std::size_t i = 0; i < count; ++i)
            if (lightmap_.Mapped(i))
                lightmap_.light[slot][i] = value, lightmap_.filled[slot][i] = 1;
    }

    /// The slot of the light's style, or a free one; kStyles if there is none.
    std::size_t SlotFor(int style) const {
        std::size_t slot = 0;
        while (slot < kStyles && lightmap_.styles[slot] != style && lightmap_.styles[slot] != kNoStyle)
            ++slot;
        return slot;
    }

    int RadiusFor(const Light &light) const {
        const float radius = std::max({0.0f, lightmap_.filterRadius, light.filterRadius});
        const int luxels = int(std::min(float(lightmap_.super) * radius / std::max(lightmap_.sampleSize, 1.0f), 1e6f));
        return luxels == 0 && (radius > 0 || in_.lightmap.filter) ? 1 : luxels;
    }

    /// The light's sum; a style that is new takes its slot.
    LuxelSum &SumFor(const Light &light, std::size_t slot) {
        if (lightmap_.light[slot].empty())
            ClearSlot(slot, {});
        lightmap_.styles[slot] = std::uint8_t(light.style);
        return worker_.sums.Find(slot, RadiusFor(light), worker_.blocks.Count());
    }

    void AddLight(const Light &light) {
        const std::size_t slot = SlotFor(light.style);
        if (slot == kStyles) {
            in_.log.Warn("light styles", "light of style {} left out on a surface that already has {} styles",
                         light.style, kStyles);
            return;
        }
        worker_.reached.clear();
        worker_.blocks.Reached(light, pass_.settings, worker_.reached);
        if (sampling_)
            worker_.sampler.StartLight(light);
        LuxelSum *sum = nullptr;
        LuxelIncidentLight incident;
        for (const std::uint32_t block : worker_.reached) {
            if (!LuxelContribution(light, pass_, in_.scene, worker_.blocks.Samples(block), incident, worker_.counts))
                continue;
            if (!sum)
                sum = &SumFor(light, slot);
            AddLanes(incident.color, light.negative ? -1.0f : 1.0f, sum->color[block]);
            if (pass_.deluxe)
                AddLanes(incident.direction, 1, sum->direction[block]);
            if (sampling_)
                worker_.sampler.Put(block, incident);
        }
        if (sampling_ && sum)
            worker_.sampler.Refine(*sum, worker_.counts);
    }

    /// Adds lanes to dense rows, blurred if the sum wants that.
    void AddDense(const std::vector<Lanes3> &lanes, int radius, std::vector<Vec3f> &to) {
        std::vector<Vec3f> &dense = radius > 0 ? worker_.dense : to;
        if (radius > 0)
            dense.assign(to.size(), {});
        for (std::size_t block = 0; block < worker_.blocks.Count(); ++block) {
            const auto &luxels = worker_.blocks.Luxels(block);
            for (std::size_t i = 0; i < worker_.blocks.Samples(block).count; ++i)
                dense[luxels[i]] += lanes[block][i];
        }
        if (radius == 0)
            return;
        worker_.filter.Apply(lightmap_, radius, dense);
        for (std::size_t i = 0; i < to.size(); ++i)
            to[i] += dense[i];
    }

    void AddSum(const LuxelSum &sum) {
        AddDense(sum.color, sum.radius, lightmap_.light[sum.slot]);
        if (pass_.deluxe)
            AddDense(sum.direction, sum.radius, lightmap_.directions);
    }

    const SurfaceInputs &in_;
    const LightsByCluster &lights_;
    RawLightmap &lightmap_;
    Worker &worker_;
    LuxelPass pass_;
    bool sampling_ = false;
};

} // namespace

LuxelSum &LuxelSums::Find(std::size_t slot, int radius, std::size_t blocks) {
    for (std::size_t i = 0; i < used; ++i)
        if (sums[i].slot == slot && sums[i].radius == radius)
            return sums[i];
    if (used == sums.size())
        sums.emplace_back();
    LuxelSum &sum = sums[used++];
    sum.slot = slot, sum.radius = radius;
    sum.color.assign(blocks, {});
    sum.direction.assign(deluxe ? blocks : 0, {});
    return sum;
}

bool LuxelContribution(const Light &light, const LuxelPass &pass, const LightScene &scene,
                       SurfaceReceiverBatch &samples, LuxelIncidentLight &out, ContributionCounts &counts) {
    SurfaceIncidentLight incident;
    LightContributionToSample(light, pass.settings, scene, samples, incident, counts);
    if (!incident.live.Any() && !incident.filtered.Any())
        return false;
    const float scale =
        pass.deluxe ? std::max(0.0f, Luminance(light.color)) / 255 * (pass.bounce ? kBounceDirections : 1) : 0;
    FillArrivals(light, incident, scale, out);
    return true;
}

void LightLuxels(const SurfaceInputs &in, const std::vector<Light> &lights, const SurfacePass &pass,
                 SurfaceLight &surfaces, ContributionCounts &counts) {
    const LightsByCluster lists(lights, true);
    // The largest first, so that no worker is left with one at the end.
    std::vector<std::size_t> order(surfaces.lightmaps.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return surfaces.lightmaps[a].luxelClusters.size() > surfaces.lightmaps[b].luxelClusters.size();
    });
    std::vector<Worker> workers(std::size_t(in.jobs.Threads()));
    std::atomic<std::uint64_t> raysSoFar{0};
    Progress progress(in.log, std::int64_t(order.size()));
    in.jobs.For(
        std::int64_t(order.size()),
        [&](std::int64_t index, int number) {
            Worker &worker = workers[std::size_t(number)];
            const std::uint64_t before = worker.counts.rays;
            LightmapPass(in, lists, pass, surfaces.lightmaps[order[std::size_t(index)]], worker).Run();
            raysSoFar += worker.counts.rays - before;
        },
        [&](std::int64_t done) { progress.Update(done, raysSoFar); });
    progress.Finish();
    for (const Worker &worker : workers)
        counts += worker.counts;
}

} // namespace q3
