// GPL-2.0-or-later. Direct light on luxels: culling of lights, visibility of named lights, debug views.
#include "q3map2/lightmap/direct/luxel_light.h"

#include "common/debug_color.h"
#include "common/error.h"
#include "common/log.h"
#include "libs/math/vec.h"
#include "q3map2/light/sources/falloff.h"
#include "q3map2/light/sources/light_units.h"
#include "q3map2/lightmap/direct/luxel_contribution.h"
#include "q3map2/lightmap/direct/luxel_filter.h"
#include "q3map2/lightmap/direct/luxel_samples.h"
#include "q3map2/lightmap/direct/luxel_soft.h"
#include "q3map2/lightmap/raw/lightmaps.h"
#include "q3map2/lightmap/raw/luxel_normal.h"
#include "q3map2/units/unit_bytes.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>

namespace q3 {

// ---- Culling of lights for a raw lightmap ----

namespace {

/// A one-sided light does not light a surface if the cosine between their normals is above this.
constexpr float kSameFacing = 0.999f;
/// Lights up to this far behind the plane of a surface count. Game units.
constexpr float kBehindPlane = 1;

/// Whether the light can reach the front side of a plane; of area lights with soft shadows, some part of it.
bool OnLitSide(const Light &light, bool softShadows, const Vec3f &center, const Vec3f &normal) {
    if (!light.twoSided && Dot(light.normal, normal) > kSameFacing)
        return false;
    const Vec3f origin = light.type == LightType::Sun ? light.normal * -kSunDistance : light.origin;
    const float radius = softShadows && light.type == LightType::Area ? ReachOfPolygon(light) : 0;
    return Dot(origin - center, normal) >= -kBehindPlane - radius;
}

} // namespace

void LuxelLightList::Build(const LightsByCluster &passLights, const RawLightmap &lightmap,
                           const SurfaceLightSettings &settings) {
    list_.clear();
    const Vec3f center = lightmap.bounds.Center();
    const float radius = 0.5f * Length(lightmap.bounds.maxs - lightmap.bounds.mins);
    const auto use = [&](std::size_t number) {
        const Light &light = passLights.Lights()[number];
        const bool sun = light.type == LightType::Sun;
        if (!light.lightsSurfaces || light.envelope <= 0 || (settings.sunOnly && !sun))
            return;
        if (!sun && (Length(light.origin - center) - light.envelope - radius > 0 || ConeMisses(light, center, radius)))
            return;
        if (lightmap.planar && !lightmap.twoSided &&
            !OnLitSide(light, settings.HasSoftShadows(), center, lightmap.planeNormal))
            return;
        list_.push_back(&light);
    };
    if (!lightmap.clusters.empty())
        passLights.ForEach(lightmap.clusters, use);
    else
        for (std::size_t i = 0; i < passLights.Lights().size(); ++i)
            use(i);
}

// ---- Shadow maps: the visibility of named lights at luxels ----

namespace {

/// Light of the named lights at the super luxels of one raw lightmap, with and without shadows.
struct NamedLight {
    std::vector<float> arriving, unshadowed;
};

enum class Shadows { Off, On };

/// Adds the luminance that the light gives each super luxel to `sums`.
void AddLight(const Light &light, Shadows shadows, const SurfaceInputs &in, const RawLightmap &raw, LuxelBlocks &blocks,
              std::vector<float> &sums, ContributionCounts &counts) {
    const SurfaceLightSettings settings{.pointAreas = in.lightmap.faster,
                                        .halfLambert = in.lightmap.halfLambert,
                                        .shadows = shadows == Shadows::On,
                                        .receiveShadows = raw.receiveShadows,
                                        .areaShadows = in.options.areaShadows};
    std::vector<std::uint32_t> reached;
    blocks.FindReached(light, settings, reached);
    SurfaceIncidentLight incident;
    for (const std::uint32_t block : reached) {
        LightContributionToSample(light, settings, in.scene, blocks.Receivers(block), incident, counts);
        for (std::size_t i = 0; i < blocks.Receivers(block).count; ++i)
            if (incident.live[i] != 0)
                sums[blocks.Luxels(block)[i]] +=
                    incident.strength[i] * (incident.tinted ? Luminance(incident.tint[i]) / Luminance({1, 1, 1}) : 1);
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
        LuxelBlocks &ownBlocks = blocks[std::size_t(worker)];
        if (in.options.areaShadows > 0)
            ownBlocks.BuildOffWalls(raw, in.space);
        else
            ownBlocks.Build(raw);
        raw.visibility.resize(names.size());
        for (std::size_t n = 0; n < names.size(); ++n) {
            NamedLight sums{std::vector<float>(raw.luxelClusters.size()), std::vector<float>(raw.luxelClusters.size())};
            for (const Light &light : lights)
                if (light.name == names[n]) {
                    AddLight(light, Shadows::On, in, raw, ownBlocks, sums.arriving, work[std::size_t(worker)]);
                    AddLight(light, Shadows::Off, in, raw, ownBlocks, sums.unshadowed, work[std::size_t(worker)]);
                }
            raw.visibility[n] = LuxelMeans(raw, -1.0f, [&](std::size_t at) {
                return sums.unshadowed[at] > 0 ? std::min(1.0f, sums.arriving[at] / sums.unshadowed[at]) : 0;
            });
        }
    });
    for (const ContributionCounts &one : work)
        counts += one;
}

// ---- Debug views: luxels show something other than light ----

void DrawDebugView(DebugView view, RawLightmap &lightmap) {
    for (std::size_t i = 0; i < lightmap.luxelClusters.size(); ++i) {
        if (!lightmap.Mapped(i))
            continue;
        Vec3f &color = lightmap.light[0][i];
        switch (view) {
        case DebugView::Light:
            break;
        case DebugView::Surfaces:
            color = DebugColor(lightmap.surfaces.empty() ? 0 : lightmap.surfaces.front());
            break;
        case DebugView::Axis:
            color = VectorColor(lightmap.axis);
            break;
        case DebugView::Cluster:
            color = DebugColor(lightmap.luxelClusters[i]);
            break;
        case DebugView::Origin:
            color = PositionColor(lightmap.positions[i], lightmap.bounds);
            break;
        case DebugView::Dirt: // FinishLuxels multiplies by it
            color = {255, 255, 255};
            break;
        case DebugView::NormalMap:
            color = VectorColor(lightmap.normals[i]);
            break;
        }
    }
}

// ---- Direct light on luxels ----

namespace {

/// Of area lights that give every luxel of a block less than this, only some are traced, with more weight
/// (SelectFaintLight). Byte scale.
constexpr float kFaint = 1.0f / 16;

void AddLanes(const Lanes3 &what, float sign, Lanes3 &sum) {
    Vectorize([&, sign]() Q3_INLINE {
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            sum.x[i] += what.x[i] * sign;
            sum.y[i] += what.y[i] * sign;
            sum.z[i] += what.z[i] * sign;
        }
    });
}

/// Memory that a worker keeps from lightmap to lightmap.
struct Worker {
    LuxelBlocks blocks;
    LuxelSums sums;
    LuxelSampler sampler;
    SoftLuxels soft;
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
        pass_ = LuxelPassOf(in, pass, lightmap);
        supersamples_ = in.lightmap.samples > 1 || in.lightmap.randomSamples;
    }

    /// Names of lights that found no place.
    const std::vector<std::string> &Dropped() const { return dropped_; }

    /// hashes: of the lights of the pass.
    void Run(std::size_t number, const LightHashes &hashes) {
        const bool isSoft = pass_.settings.HasSoftShadows() && !pass_.bounce;
        if (isSoft)
            worker_.blocks.BuildOffWalls(lightmap_, in_.space);
        else
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
        worker_.list.Build(lights_, lightmap_, pass_.settings);
        const std::optional<UnitName> unit =
            in_.units && !pass_.bounce ? std::optional(NameOfUnit(number, hashes)) : std::nullopt;
        if (unit && unit->mayBeKnown && Find(unit->key))
            return;
        if (supersamples_)
            worker_.sampler.Start(in_, lightmap_, worker_.blocks, pass_);
        if (isSoft)
            worker_.soft.Start(lightmap_, worker_.blocks);
        AddLights();
        if (unit)
            in_.units->Keep(unit->key, Bytes());
    }

  private:
    void AddLights() {
        const std::vector<LightGroup> groups = LightGroupsOf(worker_.list.Lights(), pass_.settings);
        if (StyleChoice::IsNeeded(worker_.list.Lights()))
            ChooseStyles(groups);
        for (const LightGroup &group : groups)
            AddLight(group);
        for (std::size_t i = 0; i < worker_.sums.used; ++i)
            AddSum(worker_.sums.sums[i]);
        dropped_ = styles_.DroppedLightNames();
    }

    /// How the lightmap is known in a store.
    struct UnitName {
        Hash128 key;
        bool mayBeKnown = true; ///< false: something that matters has changed since the run before
    };
    UnitName NameOfUnit(std::size_t number, const LightHashes &hashes) const {
        LightUnitKey key("luxels", hashes, *in_.units);
        key.More().Add(pass_.bounce);
        if (!in_.units->IsCache()) {
            key.More().Add(std::uint64_t(number));
            return {key.Key()};
        }
        AddLayout(key.More());
        key.AddReceivers(std::span<const SurfaceReceiverBatch>(worker_.blocks.AllReceivers()));
        for (const Light *light : worker_.list.Lights()) {
            key.AddLight(*light);
            key.More().AddText(light->style != 0 ? light->label : std::string());
        }
        return {key.Key(), !key.IsTouched()};
    }

    /// What light depends on besides receivers and lights.
    void AddLayout(KeyBuilder &key) const {
        key.Add(lightmap_.SuperWidth(), lightmap_.SuperHeight(), lightmap_.receiveShadows, lightmap_.twoSided);
        key.Add(lightmap_.ambient.x, lightmap_.ambient.y, lightmap_.ambient.z, blurAll_);
        key.AddAll(std::span<const std::uint8_t>(lightmap_.styles));
        for (std::size_t block = 0; block < worker_.blocks.Count(); ++block)
            key.AddAll(std::span(worker_.blocks.Luxels(block)).first(worker_.blocks.Receivers(block).count));
        if (!pass_.channels.Any() && !supersamples_ && !pass_.settings.HasSoftShadows())
            return;
        // Samples aside of luxels, and frames of their normals, depend on more of the map.
        key.Add(in_.units->geometry.low, in_.units->geometry.high);
    }

    /// Everything that AddLights sets.
    std::vector<std::byte> Bytes() const {
        UnitWriter writer;
        writer.Put(lightmap_.styles);
        for (std::size_t slot = 0; slot < kStyles; ++slot) {
            writer.PutAll(lightmap_.light[slot]);
            PutImages(lightmap_.directional[slot], writer);
        }
        writer.PutAll(lightmap_.directions);
        writer.Put(std::uint64_t(unblurred_.size()));
        for (const UnblurredLight &one : unblurred_) {
            writer.Put(one.style), writer.Put(one.filterRadius);
            writer.PutAll(one.color), writer.PutAll(one.direction);
            PutImages(one.channels, writer);
        }
        writer.Put(std::uint64_t(dropped_.size()));
        for (const std::string &name : dropped_)
            writer.PutText(name);
        return writer.Take();
    }

    /// False: the store does not have it, or has something that does not fit the lightmap.
    bool Find(const Hash128 &key) {
        const auto bytes = in_.units->Find(key);
        if (!bytes)
            return false;
        const std::size_t luxels = lightmap_.luxelClusters.size();
        const auto fits = [luxels](const std::vector<Vec3f> &image) { return image.empty() || image.size() == luxels; };
        const auto allFit = [&](const ChannelImages &images) {
            return (images.empty() || images.size() == lightmap_.channels.Count()) && std::ranges::all_of(images, fits);
        };
        UnitReader reader(*bytes);
        Styles styles{};
        PerStyle<std::vector<Vec3f>> light;
        PerStyle<ChannelImages> directional;
        std::vector<Vec3f> directions;
        reader.Get(styles);
        bool fit = true;
        for (std::size_t slot = 0; slot < kStyles; ++slot) {
            reader.GetAll(light[slot]);
            GetImages(reader, directional[slot]);
            fit = fit && fits(light[slot]) && allFit(directional[slot]);
        }
        reader.GetAll(directions);
        std::vector<UnblurredLight> unblurred(CountOf(reader));
        for (UnblurredLight &one : unblurred) {
            reader.Get(one.style), reader.Get(one.filterRadius);
            reader.GetAll(one.color), reader.GetAll(one.direction);
            GetImages(reader, one.channels);
            fit = fit && one.color.size() == luxels && fits(one.direction) && allFit(one.channels) &&
                  FindStyleSlot(styles, one.style) < kStyles && std::isfinite(one.filterRadius);
        }
        std::vector<std::string> dropped(CountOf(reader));
        for (std::string &name : dropped)
            reader.GetText(name);
        if (!reader.IsComplete() || !fit || !fits(directions) || light[0].size() != luxels)
            return false;
        lightmap_.styles = styles;
        for (std::size_t slot = 0; slot < kStyles; ++slot)
            if (!light[slot].empty()) {
                ClearStyleSlot(lightmap_, slot, {}); // sets `filled`
                lightmap_.light[slot] = std::move(light[slot]);
                lightmap_.directional[slot] = std::move(directional[slot]);
            }
        lightmap_.directions = std::move(directions);
        std::ranges::move(unblurred, std::back_inserter(unblurred_));
        dropped_ = std::move(dropped);
        return true;
    }

    /// A number of elements that follow, each of more than a byte.
    static std::size_t CountOf(UnitReader &reader) {
        std::uint64_t count = 0;
        reader.Get(count);
        return reader.HasRoomFor(count) ? std::size_t(count) : 0;
    }
    static void PutImages(const ChannelImages &images, UnitWriter &writer) {
        writer.Put(std::uint64_t(images.size()));
        for (const std::vector<Vec3f> &image : images)
            writer.PutAll(image);
    }
    static void GetImages(UnitReader &reader, ChannelImages &images) {
        std::uint64_t count = 0;
        reader.Get(count);
        images.resize(std::size_t(std::min(count, std::uint64_t(kMaxChannels))));
        for (std::vector<Vec3f> &image : images)
            reader.GetAll(image);
    }

    /// Sets mapped luxels to ambient light in slot 0 and to zero in others.
    void Clear() {
        const std::size_t count = lightmap_.luxelClusters.size();
        const Vec3f ambient = pass_.bounce ? Vec3f{} : lightmap_.ambient;
        for (std::size_t slot = 0; slot < kStyles; ++slot)
            if (slot == 0 || !lightmap_.light[slot].empty())
                ClearStyleSlot(lightmap_, slot, slot == 0 ? ambient : Vec3f{});
        if (!pass_.deluxe)
            return;
        const float weight = std::max(kLeastDeluxeWeight, Luminance(ambient) / 255);
        lightmap_.directions.assign(count, {});
        for (std::size_t i = 0; i < count; ++i)
            if (lightmap_.Mapped(i))
                lightmap_.directions[i] = lightmap_.normals[i] * weight;
    }

    /// The sum that the light adds to. Claims the slot for a new style.
    LuxelSum &SumFor(const Light &light, std::size_t slot) {
        if (lightmap_.light[slot].empty())
            ClearStyleSlot(lightmap_, slot, {});
        lightmap_.styles[slot] = std::uint8_t(light.style);
        return worker_.sums.FindOrAdd(slot, std::max(0.0f, light.filterRadius), worker_.blocks.Count());
    }

    void AddLight(const LightGroup &group) {
        const Light &light = group.First();
        const std::size_t slot = StyleSlotFor(lightmap_.styles, light.style);
        if (slot == kStyles || styles_.Drops(light.style))
            return;
        FindReached(group);
        const bool supersamples = supersamples_ && !IsSoft(group);
        if (supersamples)
            worker_.sampler.StartLight(group);
        LuxelSum *sum = nullptr;
        const float sign = light.negative ? -1.0f : 1.0f;
        LuxelIncidentLight luxels;
        ChannelLanes channels;
        ForLitBlocks(group, [&](std::uint32_t block, const SurfaceIncidentLight &incident) {
            SetLuxelLight(group, pass_, worker_.blocks.Basis(block), incident, luxels, channels);
            if (!sum)
                sum = &SumFor(light, slot);
            AddLanes(luxels.color, sign, sum->color[block]);
            if (pass_.deluxe)
                AddLanes(luxels.direction, 1, sum->direction[block]);
            for (std::size_t c = 0; c < pass_.channels.Count(); ++c)
                AddLanes(channels[c], sign, sum->channels[block][c]);
            if (supersamples)
                worker_.sampler.SetBlock(block, luxels, channels);
        });
        if (supersamples && sum)
            worker_.sampler.Refine(*sum, worker_.counts);
    }

    /// Whether the lights of a group have soft shadows; these have no edges for -samples to find.
    bool IsSoft(const LightGroup &group) const {
        return group.Samples().size() > 1 || (group.First().type == LightType::Area && pass_.settings.HasSoftShadows());
    }

    /// Sets worker_.reachedBlocks to the blocks that a group may reach.
    void FindReached(const LightGroup &group) {
        std::vector<std::uint32_t> &reached = worker_.reachedBlocks;
        reached.clear();
        for (const Light *sample : group.Samples()) {
            worker_.blocks.FindReached(*sample, pass_.settings, reached);
            if (sample->type == LightType::Sun)
                return; // it may reach all of them
        }
        if (group.Samples().size() > 1) {
            std::ranges::sort(reached);
            reached.erase(std::unique(reached.begin(), reached.end()), reached.end());
        }
    }

    /// Calls use(block, light) for the reached blocks at which light of the group arrives.
    template <typename Use> void ForLitBlocks(const LightGroup &group, const Use &use) {
        const SurfaceLightSettings &settings = pass_.settings;
        if (group.Samples().size() > 1)
            return worker_.soft.Add(SoftSampledLight(group, settings, in_.scene, worker_.counts), worker_.reachedBlocks,
                                    use);
        const Light &light = group.First();
        if (IsSoft(group))
            return worker_.soft.Add(SoftAreaLight(light, settings, in_.scene, worker_.counts), worker_.reachedBlocks,
                                    use);
        SurfaceIncidentLight incident;
        for (const std::uint32_t block : worker_.reachedBlocks) {
            LightContributionToSample(light, settings, in_.scene, worker_.blocks.Receivers(block), incident,
                                      worker_.counts);
            if (incident.live.Any() || incident.filtered.Any())
                use(block, incident);
        }
    }

    /// Measures the light of all styles to find those to drop.
    void ChooseStyles(std::span<const LightGroup> groups) {
        for (const LightGroup &group : groups) {
            double energy = 0;
            if (group.First().style != 0) {
                FindReached(group);
                ForLitBlocks(group, [&](std::uint32_t block, const SurfaceIncidentLight &incident) {
                    Lanes3 color;
                    SetIncidentColor(group.Color(), incident, incident.strength, color);
                    for (std::size_t i = 0; i < worker_.blocks.Receivers(block).count; ++i)
                        energy += double(color.x[i]) + double(color.y[i]) + double(color.z[i]);
                });
            }
            styles_.Add(group.First(), energy);
        }
        styles_.Choose();
    }

    /// Adds a sum to luxels. lanesOf(block): the sum of a block.
    template <typename LanesOf> void AddLanesToLuxels(const LanesOf &lanesOf, std::vector<Vec3f> &to) const {
        for (std::size_t block = 0; block < worker_.blocks.Count(); ++block) {
            const auto &luxels = worker_.blocks.Luxels(block);
            const Lanes3 &lanes = lanesOf(block);
            for (std::size_t i = 0; i < worker_.blocks.Receivers(block).count; ++i)
                to[luxels[i]] += lanes[i];
        }
    }

    void AddToLuxels(const LuxelSum &sum, std::vector<Vec3f> &light, std::vector<Vec3f> &directions,
                     ChannelImages &channels) const {
        AddLanesToLuxels([&](std::size_t block) -> const Lanes3 & { return sum.color[block]; }, light);
        if (pass_.deluxe)
            AddLanesToLuxels([&](std::size_t block) -> const Lanes3 & { return sum.direction[block]; }, directions);
        for (std::size_t c = 0; c < pass_.channels.Count(); ++c)
            AddLanesToLuxels([&](std::size_t block) -> const Lanes3 & { return sum.channels[block][c]; }, channels[c]);
    }

    /// Adds a sum to the lightmap, or keeps it until those of all lightmaps are known, if it is to be blurred.
    void AddSum(const LuxelSum &sum) {
        if (!blurAll_ && sum.filterRadius == 0)
            return AddToLuxels(sum, lightmap_.light[sum.slot], lightmap_.directions, lightmap_.directional[sum.slot]);
        const std::vector<Vec3f> zero(lightmap_.luxelClusters.size());
        UnblurredLight &kept = unblurred_.emplace_back();
        kept.style = lightmap_.styles[sum.slot], kept.filterRadius = sum.filterRadius;
        kept.color = zero;
        if (pass_.deluxe)
            kept.direction = zero;
        kept.channels.assign(pass_.channels.Count(), zero);
        AddToLuxels(sum, kept.color, kept.direction, kept.channels);
    }

    const SurfaceInputs &in_;
    const LightsByCluster &lights_;
    RawLightmap &lightmap_;
    Worker &worker_;
    LuxelPass pass_;
    StyleChoice styles_;
    std::vector<std::string> dropped_;
    bool supersamples_ = false; // -samples above 1, or -randomsamples
    const bool blurAll_;        // not only light of sources with a filter radius
    std::vector<UnblurredLight> &unblurred_;
};

} // namespace

LuxelPass LuxelPassOf(const SurfaceInputs &in, const SurfacePass &pass, const RawLightmap &lightmap) {
    LuxelPass result;
    result.bounce = pass.bounce;
    result.deluxe = in.lightmap.deluxe;
    result.channels = lightmap.channels;
    result.settings = {.sunOnly = in.options.sunOnly,
                       .pointAreas = in.lightmap.faster,
                       .halfLambert = in.lightmap.halfLambert,
                       .receiveShadows = lightmap.receiveShadows,
                       .faint = in.options.skip.faint ? kFaint : 0,
                       .directional = lightmap.channels.Any(),
                       .areaShadows = in.options.areaShadows};
    return result;
}

void LightLuxels(const SurfaceInputs &in, const std::vector<Light> &lights, const SurfacePass &pass,
                 SurfaceLight &surfaces, ContributionCounts &counts) {
    const LightsByCluster lists(lights, SunsSeen::Everywhere);
    const LightHashes hashes(lights, in.units);
    // The largest first, so that all workers finish at about the same time.
    std::vector<std::size_t> order(surfaces.lightmaps.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return surfaces.lightmaps[a].luxelClusters.size() > surfaces.lightmaps[b].luxelClusters.size();
    });
    if (in.units && in.units->IsPartOfFirstRound()) {
        std::vector<double> costs;
        for (const RawLightmap &raw : surfaces.lightmaps)
            costs.push_back(double(raw.luxelClusters.size()));
        const std::vector<std::uint8_t> own = in.units->Own(costs, UnitStore::Division::BySize);
        std::erase_if(order, [&](std::size_t number) { return own[number] == 0; });
    }
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
            one.Run(lightmap, hashes);
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
