// GPL-2.0-or-later. What one light gives to points of a light grid.
#include "q3map2/light/light_contribution.h"

#include "q3map2/light/light_area.h"
#include "q3map2/light/light_formfactor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// No light is stronger than at this distance. Game units.
constexpr float kNearest = 16;
constexpr float kLinearScale = 1.0f / 8000;
/// A spotlight fades over this much at the rim of its cone. Game units.
constexpr float kConeFade = 32;
/// Area lights are evaluated from at least this far in front in the legacy grid. Game units.
constexpr float kAreaPush = 8;
/// Byte scale; far under what a byte can show.
constexpr float kFarError = 1.0f / 256;

/// Falloff and cone of point lights and spotlights: light at distance d along `toLight` (not normalised).
float PointAdd(const Light &light, const Vec3f &toLight, float d) {
    const float dAttenuated = std::max(kNearest, std::sqrt(d * d + light.extraDist * light.extraDist));
    float add = light.linear ? light.photons * kLinearScale - dAttenuated * light.fade
                             : light.photons / (dAttenuated * dAttenuated);
    if (light.type == LightType::Spot && add > 0) {
        const float along = -Dot(toLight, light.normal);
        if (along < 0)
            return 0;
        const float coneRadius = light.radiusByDist * along;
        const float off = Length(-toLight - light.normal * along);
        if (off >= coneRadius)
            return 0;
        if (off > coneRadius - kConeFade)
            add *= (coneRadius - off) / kConeFade;
    }
    return std::max(add, 0.0f);
}

/// Area light as a point with a cosine, where that errs by less than kFarError; else 0.
float FarAreaAdd(const Light &light, const Vec3f &p) {
    const AreaShape &shape = light.shape;
    const Vec3f toCenter = shape.center - p;
    const float d2 = Dot(toCenter, toCenter);
    const float relativeError = shape.radius * shape.radius / d2;
    const float height = std::abs(float(Dot(shape.normal, Vec3d(p)) - shape.dist));
    const float add = light.add * shape.area * height / (d2 * std::sqrt(d2) * std::numbers::pi_v<float>);
    return height > kAreaPush && add * relativeError < kFarError ? add : 0;
}

/// Area light by the established program's formula.
float LegacyAreaAdd(const Light &light, const Vec3f &p, const Vec3f &u, float d, bool pointAreas) {
    if (pointAreas) {
        const float dAttenuated = std::max(kNearest, std::sqrt(d * d + light.extraDist * light.extraDist));
        return light.photons / (dAttenuated * dAttenuated);
    }
    const float s = Dot(p, light.normal) - light.dist;
    if (!light.twoSided && s < -1)
        return 0;
    if (const float add = FarAreaAdd(light, p); add > 0)
        return add;
    Vec3f pushed = p;
    if (s > -kAreaPush && s < kAreaPush)
        pushed += light.normal * (kAreaPush - s);
    const float f = FormFactor(pushed, u, light.w);
    return (f < 0 && !light.twoSided ? 0 : std::abs(f)) * light.add;
}

/// Light without shadows at one point. False: none.
bool Unshadowed(const Light &light, const ContributionSettings &settings, const Vec3f &p, Arrival &arrival,
                float &distance) {
    if (light.type == LightType::Sun) {
        arrival.add = light.photons;
        arrival.direction = -light.normal;
        distance = kFar;
        return arrival.add > 0;
    }
    const Vec3f toLight = light.origin - p;
    distance = Length(toLight);
    if (distance > light.envelope || !light.bounds.Contains(p))
        return false;
    arrival.direction = distance > 0 ? toLight / distance : Vec3f{};
    arrival.add = light.type == LightType::Area
                      ? LegacyAreaAdd(light, p, arrival.direction, distance, settings.pointAreas)
                      : PointAdd(light, toLight, distance);
    return arrival.add > 0 && !(light.fast && arrival.add <= light.tolerance);
}

std::array<float, 9> DirectionMoments(const Vec3f &direction, float add, bool radiance) {
    std::array<float, 9> moments{};
    if (direction == Vec3f{}) // the light is at the point: from everywhere alike
        moments[0] = float(kShC0);
    else
        moments = ShBasis(direction);
    for (std::size_t k = 0; k < moments.size(); ++k)
        moments[k] *= add * (radiance ? 1 : float(kCosineLobe[k]));
    return moments;
}

/// Rays of one light towards many places, traced as soon as a packet is full.
class DeltaRays {
  public:
    DeltaRays(const Light &light, const ContributionSettings &settings, const LightScene &scene,
              std::vector<Arrival> &arrivals, ContributionCounts &counts)
        : light_(light), settings_(settings), scene_(scene), arrivals_(arrivals), counts_(counts) {}

    void Add(const LightPlace &place, const Arrival &arrival, float distance) {
        const auto ray = std::size_t(rays_.count++);
        pending_[ray] = arrival;
        rays_.origin[ray] = place.rayOrigin;
        rays_.direction[ray] = arrival.direction;
        rays_.distance[ray] = distance;
        rays_.blocked[ray] = false;
        if (rays_.count == kPacketSize)
            Flush();
    }

    void Flush() {
        if (rays_.count == 0)
            return;
        const bool exact = settings_.pass == LightPass::GridSH;
        const ShadowRules rules = exact ? ShadowRules::Exact : ShadowRules::LegacyGrid;
        if (light_.type == LightType::Sun)
            scene_.TraceToSky(rays_, light_.skyIndex, rules, counts_);
        else
            scene_.TraceToLight(rays_, rules, counts_);
        for (std::size_t ray = 0; ray < std::size_t(rays_.count); ++ray) {
            if (rays_.blocked[ray])
                continue;
            Arrival &arrival = arrivals_.emplace_back(pending_[ray]);
            arrival.visible = rays_.tint[ray];
            if (exact)
                arrival.moments = DirectionMoments(arrival.direction, arrival.add, settings_.radiance);
        }
        rays_.count = 0;
    }

  private:
    const Light &light_;
    const ContributionSettings &settings_;
    const LightScene &scene_;
    std::vector<Arrival> &arrivals_;
    ContributionCounts &counts_;
    RayPacket rays_;
    std::array<Arrival, kPacketSize> pending_;
};

bool InSight(const Light &light, const ContributionSettings &settings, const LightPlace &place) {
    if (settings.sunOnly && light.type != LightType::Sun)
        return false;
    return settings.ignorePvs || light.SeenFrom(place.cluster);
}

} // namespace

void LightContributionToPoint(const Light &light, float weight, const ContributionSettings &settings,
                              const LightScene &scene, std::span<LightPlace> places, std::vector<Arrival> &arrivals,
                              ContributionCounts &counts) {
    arrivals.clear();
    const bool exactArea = light.type == LightType::Area && settings.pass == LightPass::GridSH;
    DeltaRays delta(light, settings, scene, arrivals, counts);
    AreaRays area(light, settings, scene, arrivals, counts);
    for (std::size_t i = 0; i < places.size(); ++i) {
        LightPlace &place = places[i];
        if (place.skip)
            continue;
        ++counts.pairs;
        if (!InSight(light, settings, place)) {
            ++counts.skippedPvs;
            continue;
        }
        if (exactArea) {
            area.Add(place, std::uint32_t(i), weight);
            continue;
        }
        Arrival arrival;
        arrival.place = std::uint32_t(i);
        float distance = 0;
        arrival.weight = weight;
        if (!Unshadowed(light, settings, place.position, arrival, distance))
            ++counts.skippedFacing;
        else if (light.type == LightType::Area && !TakeFaint(settings.faint, arrival.add, place, arrival.weight))
            ++counts.skippedFaint;
        else
            delta.Add(place, arrival, distance);
    }
    delta.Flush();
    area.Flush();
}

float LightBound(const Light &light, const Boundsf &box) {
    const float strongest = MaxComponent(Max(light.color, -light.color));
    if (light.type == LightType::Sun)
        return strongest * light.photons;
    if (light.type == LightType::Area) {
        // The cosine-weighted share of the hemisphere is at most area cos / (pi d^2): d the least distance from the
        // box, cos the emitter's cosine at the greatest height of the box over its plane.
        const AreaShape &shape = light.shape;
        const float d = box.Distance(shape.center) - shape.radius;
        const Vec3f n(shape.normal), half = (box.maxs - box.mins) * 0.5f;
        const float reach = std::abs(n.x) * half.x + std::abs(n.y) * half.y + std::abs(n.z) * half.z;
        const float height = std::abs(Dot(n, box.Center()) - float(shape.dist)) + reach;
        const float share = d > 0 ? shape.area * std::min(1.0f, height / d) / (std::numbers::pi_v<float> * d * d) : 1;
        return strongest * light.add * std::min(1.0f, share);
    }
    const float d = std::max(kNearest, box.Distance(light.origin));
    if (light.linear)
        return strongest * std::max(0.0f, light.photons * kLinearScale - (light.fade > 0 ? d * light.fade : 0));
    return strongest * light.photons / (d * d);
}

} // namespace q3
