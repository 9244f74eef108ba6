// GPL-2.0-or-later. What each light gives a receiver, and why the others give nothing.
#include "q3map2/lightmap/explain/explain_lights.h"

#include "libs/math/sampling.h"
#include "q3map2/light/grid/grid_bricks.h"
#include "q3map2/light/sources/falloff.h"
#include "q3map2/light/sources/hidden_lights.h"
#include "q3map2/light/transfer/area_sampler.h"

#include <algorithm>
#include <functional>
#include <map>
#include <tuple>

namespace q3 {

namespace {

/// Obstacles are looked for between the receiver and so many of the strongest lights.
constexpr std::size_t kMostWithObstacles = 32;
/// A light of which a smaller share arrives is in shadow; what is missing above it is rounding.
constexpr float kUnshadowedShare = 0.999f;
/// Lights below this have no account of obstacles. Byte scale.
constexpr float kLeastLight = 0.01f;

Vec3f AimOf(const Light &light) {
    return light.type == LightType::Area ? light.shape.center : light.origin;
}

float DistanceOf(const Light &light, const Vec3f &p) {
    return light.type == LightType::Sun ? 0 : Length(AimOf(light) - p);
}

/// Appends rays from a point to places of a light, as the SH grid samples it.
void AddShadowRays(const Light &light, const Vec3f &p, std::size_t count, std::vector<ShadowRay> &shadowRays) {
    const auto add = [&](const Vec3f &to) {
        const Vec3f toLight = to - p;
        const float length = Length(toLight);
        if (length > 0)
            shadowRays.push_back({toLight / length, length});
    };
    if (light.type == LightType::Sun)
        shadowRays.push_back({-light.normal, kSunDistance});
    else if (light.type != LightType::Area)
        add(light.origin);
    else {
        const float height = Dot(Vec3f(light.shape.normal), p) - float(light.shape.dist);
        const float gap = std::min(kEmitterGap, std::abs(height) / 2) * (height < 0 ? -1.0f : 1.0f);
        for (std::size_t i = 0; i < count; ++i)
            add(SampleUniformArea(light, PlasticSample(std::uint32_t(i), 0)) + Vec3f(light.shape.normal) * gap);
    }
}

/// Appends the one ray from a luxel to a light. That to the back of a two-sided area light ends 1 unit behind the
/// polygon, 2 units behind the origin, which is 1 unit in front of it.
void AddLuxelShadowRay(const Light &light, const Vec3f &p, std::vector<ShadowRay> &shadowRays) {
    if (light.type != LightType::Area)
        return AddShadowRays(light, p, 1, shadowRays);
    const bool behind = light.twoSided && Dot(light.normal, p) < light.dist - 1;
    const Vec3f toLight = light.origin - light.normal * (behind ? 2.0f : 0.0f) - p;
    if (const float length = Length(toLight); length > 0)
        shadowRays.push_back({toLight / length, length});
}

} // namespace

std::vector<PreparedLight> PrepareLights(const LightSetup &setup, LightPass pass, bool fastPoint) {
    std::vector<PreparedLight> result;
    for (const Light &given : setup.lights) {
        PreparedLight &prepared = result.emplace_back();
        Light asked = given;
        asked.lightsGrid = asked.lightsSurfaces = true; // so that it is left out by its place or reach only
        int culled = 0;
        std::vector<Light> kept =
            SetupEnvelopes({asked}, pass, setup.options, setup.space, setup.skySeenFrom, culled, fastPoint);
        prepared.isUsed = !kept.empty();
        Vec3f origin = given.origin;
        if (kept.empty())
            prepared.fate = given.type != LightType::Sun && NudgeIntoOpen(origin, setup.space) < 0
                                ? LightFate::InSolid
                                : LightFate::OutOfReach;
        if (kept.empty())
            prepared.light = given;
        else
            prepared.light = std::move(kept.front());
        prepared.light.lightsGrid = given.lightsGrid, prepared.light.lightsSurfaces = given.lightsSurfaces;
        const auto exclude = [&](LightFate fate) { prepared.isUsed = false, prepared.fate = fate; };
        if (setup.options.sunOnly && given.type != LightType::Sun)
            exclude(LightFate::NotSun);
        if (prepared.isUsed && pass == LightPass::GridSH && given.style != 0)
            exclude(LightFate::Styled);
        if (prepared.fate != LightFate::InSolid && pass == LightPass::Surfaces && !given.lightsSurfaces)
            exclude(LightFate::NotForSurfaces);
        if (prepared.fate != LightFate::InSolid && pass != LightPass::Surfaces && !given.lightsGrid)
            exclude(LightFate::NotForGrids);
    }
    return result;
}

LightFate LightExplainer::WhyNothing(const PreparedLight &prepared, const Vec3f &p, int cluster,
                                     const Vec3f *normal) const {
    const Light &light = prepared.light;
    if (!prepared.isUsed)
        return prepared.fate;
    if (!light.seenFrom.empty() && !light.SeenFrom(cluster))
        return LightFate::HiddenByVis;
    if (light.type == LightType::Sun)
        return normal ? LightFate::FacesAway : LightFate::TooFaint;
    if (normal && Dot(light.origin - p, *normal) < 0)
        return LightFate::FacesAway;
    if (light.type == LightType::Area && !light.twoSided &&
        Dot(light.normal, p) < Dot(light.normal, light.polygon.front()))
        return LightFate::BehindEmitter;
    if (light.type == LightType::Spot && ConeFraction(light, light.origin - p) <= 0)
        return LightFate::OutsideCone;
    if (Length(light.origin - p) >= light.envelope || light.bounds.Distance(p) > 0)
        return LightFate::OutOfReach;
    return LightFate::TooFaint;
}

Obstacle LightExplainer::SolidOf(const Light &light) const {
    const auto solid = obstacles_.SolidAt(light.origin);
    return solid ? *solid : Obstacle{};
}

LightAccount LightExplainer::AccountOf(const Light &light) const {
    LightAccount account;
    account.type = light.type;
    account.surface = light.surface;
    account.shader = obstacles_.ShaderOf(light.surface);
    account.style = light.style;
    account.negative = light.negative;
    if (light.entity >= 0)
        account.source = source_.OfLight(light.entity);
    else if (light.type == LightType::Area)
        account.source = obstacles_.OfSurface(light.surface, light.shape.center, Vec3f(light.shape.normal));
    return account;
}

/// A light at a receiver.
struct LightExplainer::Part {
    std::size_t light = 0;
    Vec3f unshadowed, arriving;
    LightFate fate = LightFate::Arrives;
};

/// Joins parts to accounts: lights of one entity, of one surface, and samples of one sun.
class LightExplainer::Accounts {
  public:
    using ShadowRays = std::function<void(const Light &, std::size_t count, std::vector<ShadowRay> &)>;

    Accounts(const LightExplainer &of, const std::vector<PreparedLight> &lights, const Vec3f &p)
        : of_(of), lights_(lights), p_(p) {}

    void Add(const Part &part) {
        const Light &light = lights_[part.light].light;
        const bool isSun = light.type == LightType::Sun;
        const Key key{light.entity, light.surface, int(light.type), isSun ? light.photons : 0};
        const bool isAlone = light.entity < 0 && light.surface < 0 && !isSun;
        const auto [found, isNew] = numbers_.emplace(key, groups_.size());
        if (isNew || isAlone)
            groups_.push_back({});
        Group &group = groups_[isAlone ? groups_.size() - 1 : found->second];
        group.parts.push_back(part);
        group.unshadowed += part.unshadowed, group.arriving += part.arriving;
    }

    /// The accounts; shadowRays(light, count, rays) appends about `count` rays to a light.
    std::vector<LightAccount> Finish(const ShadowRays &shadowRays, const Vec3f &from, RayRules rules) {
        for (Group &group : groups_)
            std::ranges::stable_sort(group.parts, [&](const Part &a, const Part &b) {
                return std::tuple(-MaxComponent(a.unshadowed), DistanceOf(lights_[a.light].light, p_)) <
                       std::tuple(-MaxComponent(b.unshadowed), DistanceOf(lights_[b.light].light, p_));
            });
        // Lights that may arrive, the strongest first; then the others, the nearest first.
        const auto rank = [&](const Group &group) {
            const bool mayArrive = IsCandidate(group);
            return std::tuple(mayArrive ? 0 : 1, mayArrive ? -MaxComponent(group.unshadowed) : 0.0f,
                              DistanceOf(lights_[group.parts.front().light].light, p_));
        };
        std::ranges::stable_sort(groups_, [&](const Group &a, const Group &b) { return rank(a) < rank(b); });
        std::vector<LightAccount> accounts;
        for (const Group &group : groups_)
            accounts.push_back(AccountOf(group, shadowRays, from, rules, accounts.size() < kMostWithObstacles));
        return accounts;
    }

  private:
    /// Entity, surface, type and, for suns, photons, which the samples of one sun have in common.
    using Key = std::tuple<int, int, int, float>;
    struct Group {
        std::vector<Part> parts;
        Vec3f unshadowed, arriving;
    };

    static bool IsCandidate(const Group &group) {
        return std::ranges::any_of(group.parts, [](const Part &part) { return part.fate == LightFate::Arrives; });
    }

    LightAccount AccountOf(const Group &group, const ShadowRays &shadowRays, const Vec3f &from, RayRules rules,
                           bool withObstacles) const {
        const Part &first = group.parts.front();
        const Light &light = lights_[first.light].light;
        LightAccount account = of_.AccountOf(light);
        account.parts = int(group.parts.size());
        account.origin = light.type == LightType::Sun ? -light.normal : AimOf(light);
        account.distance = DistanceOf(light, p_);
        account.unshadowed = group.unshadowed, account.arriving = group.arriving;
        const auto candidate =
            std::ranges::find_if(group.parts, [](const Part &part) { return part.fate == LightFate::Arrives; });
        account.fate = candidate == group.parts.end()  ? first.fate
                       : Luminance(group.arriving) > 0 ? LightFate::Arrives
                                                       : LightFate::Blocked;
        if (account.fate == LightFate::InSolid)
            account.inside = of_.SolidOf(light);
        const bool isShadowed = Luminance(group.arriving) < kUnshadowedShare * Luminance(group.unshadowed);
        if (withObstacles && candidate != group.parts.end() && isShadowed && Luminance(group.unshadowed) > kLeastLight)
            account.obstacles = Obstacles(group, shadowRays, from, rules);
        return account;
    }

    std::vector<Obstacle> Obstacles(const Group &group, const ShadowRays &shadowRays, const Vec3f &from,
                                    RayRules rules) const {
        std::vector<ShadowRay> all;
        const std::size_t each = std::max<std::size_t>(1, kPacketSize / group.parts.size());
        for (const Part &part : group.parts)
            if (part.fate == LightFate::Arrives && all.size() < kPacketSize)
                shadowRays(lights_[part.light].light, each, all);
        all.resize(std::min(all.size(), kPacketSize));
        const Light &light = lights_[group.parts.front().light].light;
        rules.toSky = light.type == LightType::Sun;
        rules.skyIndex = light.skyIndex;
        return of_.obstacles_.Blocking(from, all, rules);
    }

    const LightExplainer &of_;
    const std::vector<PreparedLight> &lights_;
    Vec3f p_;
    std::map<Key, std::size_t> numbers_;
    std::vector<Group> groups_;
};

std::vector<LightAccount> LightExplainer::AtPoint(const std::vector<PreparedLight> &lights, const Vec3f &p,
                                                  int cluster) const {
    ContributionCounts counts;
    LightSettings shadowed = IncidentLightTracer::SettingsOf(
        setup_.options, setup_.options.shRadiance ? SHQuantity::Radiance : SHQuantity::Irradiance);
    LightSettings plain = shadowed;
    plain.shadows = plain.skip.pvs = plain.sunOnly = false;
    const auto light = [&](const Light &one, const LightSettings &settings) {
        ReceiverBatch batch;
        batch.Add(p, p, cluster, 0);
        std::vector<ProbeIncidentLight> incident(1);
        LightContributionToPoint(one, 1, settings, setup_.scene, {&batch, 1}, incident, counts);
        if (incident[0].live[0] == 0)
            return Vec3f{};
        return one.color * incident[0].strength[0] * (incident[0].tinted ? incident[0].tint[0] : Vec3f{1, 1, 1});
    };
    Accounts accounts(*this, lights, p);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const PreparedLight &one = lights[i];
        Part part;
        part.light = i;
        const bool isHidden = !one.light.seenFrom.empty() && !one.light.SeenFrom(cluster) && setup_.options.skip.pvs;
        if (one.fate != LightFate::InSolid)
            part.unshadowed = light(one.light, plain);
        if (!one.isUsed || isHidden || Luminance(part.unshadowed) <= 0)
            part.fate = WhyNothing(one, p, cluster, nullptr);
        else
            part.arriving = light(one.light, shadowed);
        accounts.Add(part);
    }
    return accounts.Finish([&](const Light &one, std::size_t count,
                               std::vector<ShadowRay> &shadowRays) { AddShadowRays(one, p, count, shadowRays); },
                           p, {});
}

std::vector<LightAccount> LightExplainer::AtLuxel(const std::vector<PreparedLight> &lights, const RawLightmap &lightmap,
                                                  const LuxelPass &pass, std::span<const LuxelReceiver> receivers,
                                                  std::vector<Vec3f> &arriving) const {
    ContributionCounts counts;
    SurfaceLightSettings shadowed = pass.settings;
    shadowed.faint = 0, shadowed.directional = false;
    SurfaceLightSettings plain = shadowed;
    plain.shadows = plain.sunOnly = false;
    arriving.assign(receivers.size(), {});
    const auto lightUp = [&](const Light &one, const SurfaceLightSettings &settings, std::vector<Vec3f> &values) {
        values.assign(receivers.size(), {});
        for (std::size_t first = 0; first < receivers.size(); first += kPacketSize) {
            SurfaceReceiverBatch batch;
            batch.twoSided = lightmap.twoSided;
            const std::size_t end = std::min(receivers.size(), first + kPacketSize);
            for (std::size_t i = first; i < end; ++i)
                batch.Add(receivers[i].position, receivers[i].normal, receivers[i].cluster);
            SurfaceIncidentLight incident;
            LightContributionToSample(one, settings, setup_.scene, batch, incident, counts);
            for (std::size_t i = first; i < end; ++i)
                if (incident.live[i - first] != 0)
                    values[i] = one.color * incident.strength[i - first] *
                                (incident.tinted ? incident.tint[i - first] : Vec3f{1, 1, 1});
        }
    };
    const auto mean = [&](const std::vector<Vec3f> &values) {
        Vec3f sum;
        float count = 0;
        for (std::size_t i = 0; i < receivers.size(); ++i)
            if (receivers[i].inMean)
                sum += values[i], ++count;
        return count > 0 ? sum / count : sum;
    };
    const LuxelReceiver &center = receivers.front();
    Accounts accounts(*this, lights, center.position);
    std::vector<Vec3f> values;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const PreparedLight &one = lights[i];
        Part part;
        part.light = i;
        Light open = one.light;
        open.lightsSurfaces = true;
        open.seenFrom.clear();
        if (one.fate != LightFate::InSolid) {
            lightUp(open, plain, values);
            part.unshadowed = mean(values);
        }
        const bool isHidden = !one.light.seenFrom.empty() && !one.light.SeenFrom(center.cluster);
        if (!one.isUsed || isHidden || Luminance(part.unshadowed) <= 0)
            part.fate = WhyNothing(one, center.position, center.cluster, &center.normal);
        else {
            lightUp(one.light, shadowed, values);
            part.arriving = mean(values);
            for (std::size_t k = 0; k < values.size(); ++k)
                arriving[k] += values[k] * (one.light.negative ? -1.0f : 1.0f);
        }
        accounts.Add(part);
    }
    RayRules rules;
    rules.ofSurface = true;
    rules.receiveShadows = pass.settings.receiveShadows;
    return accounts.Finish(
        [&](const Light &one, std::size_t, std::vector<ShadowRay> &shadowRays) {
            AddLuxelShadowRay(one, center.position, shadowRays);
        },
        center.position, rules);
}

} // namespace q3
