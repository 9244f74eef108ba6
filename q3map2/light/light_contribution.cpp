// GPL-2.0-or-later. What one light gives to places of a light grid.
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

/// Share of a spotlight that its cone leaves along `toLight` (not normalised).
float ConeShare(const Light &light, const Vec3f &toLight) {
    const float along = -Dot(toLight, light.normal);
    if (along < 0)
        return 0;
    const float coneRadius = light.radiusByDist * along;
    const float off = Length(-toLight - light.normal * along);
    if (off >= coneRadius)
        return 0;
    return off > coneRadius - kConeFade ? (coneRadius - off) / kConeFade : 1;
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
float LegacyAreaAdd(const Light &light, const Vec3f &p, const Vec3f &u, float d, const ContributionSettings &settings) {
    if (settings.pointAreas) {
        const float dAttenuated = std::max(kNearest, std::sqrt(d * d + light.extraDist * light.extraDist));
        return light.photons / (dAttenuated * dAttenuated);
    }
    const float s = Dot(p, light.normal) - light.dist;
    if (!light.twoSided && s < -1)
        return 0;
    if (settings.skip.moments)
        if (const float add = FarAreaAdd(light, p); add > 0)
            return add;
    Vec3f pushed = p;
    if (s > -kAreaPush && s < kAreaPush)
        pushed += light.normal * (kAreaPush - s);
    const float f = FormFactor(pushed, u, light.w);
    return (f < 0 && !light.twoSided ? 0 : std::abs(f)) * light.add;
}

/// Places that may see the light.
LaneMask InSight(const Light &light, const ContributionSettings &settings, const LightPlaces &places,
                 ContributionCounts &counts) {
    if (settings.sunOnly && light.type != LightType::Sun)
        return {};
    LaneMask live = places.wanted;
    counts.pairs += std::uint64_t(live.Count());
    if (!settings.skip.pvs || light.seenFrom.empty())
        return live;
    int last = kSolidCluster;
    bool seen = false;
    for (std::size_t i = 0; i < places.count; ++i) {
        if (places.cluster[i] != last || i == 0) {
            last = places.cluster[i];
            seen = light.SeenFrom(last);
        }
        live[i] = seen ? live[i] : 0;
    }
    counts.skippedPvs += std::uint64_t(places.wanted.Count() - live.Count());
    return live;
}

/// Direction and distance to the light; ends places beyond its reach.
void AimAt(const Light &light, const LightPlaces &places, Arrivals &arrivals, Lanes &distance) {
    const Vec3f from = light.bounds.mins, to = light.bounds.maxs;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float px = places.position.x[i], py = places.position.y[i], pz = places.position.z[i];
        const float x = light.origin.x - px, y = light.origin.y - py, z = light.origin.z - pz;
        const float d = std::sqrt(x * x + y * y + z * z), divisor = d > 0 ? d : 1;
        distance[i] = d;
        arrivals.direction.x[i] = x / divisor;
        arrivals.direction.y[i] = y / divisor;
        arrivals.direction.z[i] = z / divisor;
        const bool inside = (px >= from.x) & (py >= from.y) & (pz >= from.z) & (px <= to.x) & (py <= to.y) &
                            (pz <= to.z) & (d <= light.envelope);
        arrivals.live[i] = inside ? arrivals.live[i] : 0;
    }
}

/// Falloff of point lights and spotlights.
void PointAdd(const Light &light, const Lanes &distance, Arrivals &arrivals) {
    const float extra2 = light.extraDist * light.extraDist;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float d = std::max(kNearest, std::sqrt(distance[i] * distance[i] + extra2));
        arrivals.add[i] = light.linear ? light.photons * kLinearScale - d * light.fade : light.photons / (d * d);
    }
    if (light.type != LightType::Spot)
        return;
    for (std::size_t i = 0; i < kPacketSize; ++i)
        if (arrivals.live[i] != 0 && arrivals.add[i] > 0)
            arrivals.add[i] *= ConeShare(light, arrivals.direction[i] * distance[i]);
}

/// Light without shadows.
void Unshadowed(const Light &light, const ContributionSettings &settings, const LightPlaces &places, Arrivals &arrivals,
                Lanes &distance) {
    if (light.type == LightType::Sun) {
        arrivals.add.fill(light.photons);
        arrivals.direction.Fill(-light.normal);
        distance.fill(kFar);
    } else {
        AimAt(light, places, arrivals, distance);
        if (light.type != LightType::Area)
            PointAdd(light, distance, arrivals);
        else
            for (std::size_t i = 0; i < kPacketSize; ++i)
                arrivals.add[i] = arrivals.live[i] == 0 ? 0
                                                        : LegacyAreaAdd(light, places.position[i],
                                                                        arrivals.direction[i], distance[i], settings);
    }
    const float least = light.fast && light.type != LightType::Sun ? light.tolerance : 0;
    for (std::size_t i = 0; i < kPacketSize; ++i)
        arrivals.live[i] = arrivals.add[i] > least ? arrivals.live[i] : 0;
}

/// Moments of light from one direction; from everywhere alike in the light itself, where the direction is zero.
void DirectionMoments(Arrivals &arrivals, bool radiance) {
    std::array<float, 9> scale;
    for (std::size_t k = 0; k < 9; ++k)
        scale[k] = radiance ? 1 : float(kCosineLobe[k]);
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float x = arrivals.direction.x[i], y = arrivals.direction.y[i], z = arrivals.direction.z[i];
        const float add = arrivals.live[i] != 0 ? arrivals.add[i] : 0;
        const auto basis = ShFromMoments<float>(1, Vec3f{x, y, z}, x * y, y * z, z * z, x * z, x * x - y * y);
        for (std::size_t k = 0; k < 9; ++k)
            arrivals.moments[k][i] = basis[k] * scale[k] * add;
        // 3 z^2 - 1, and 0 instead of -1 where there is no direction.
        arrivals.moments[6][i] = float(kShC3) * (2 * z * z - x * x - y * y) * scale[6] * add;
    }
}

float Strongest(const Arrivals &arrivals) {
    float strongest = 0;
    for (std::size_t i = 0; i < kPacketSize; ++i)
        strongest = std::max(strongest, arrivals.live[i] != 0 ? arrivals.add[i] : 0);
    return strongest;
}

void Trace(const Light &light, const ContributionSettings &settings, const LightScene &scene, const LightPlaces &places,
           const Lanes &distance, Arrivals &arrivals, ContributionCounts &counts) {
    RayPacket rays;
    rays.origin = places.rayOrigin;
    rays.direction = arrivals.direction;
    rays.distance = distance;
    rays.live = arrivals.live;
    const ShadowRules rules = settings.pass == LightPass::GridSH ? ShadowRules::Exact : ShadowRules::LegacyGrid;
    if (light.type == LightType::Sun)
        scene.TraceToSky(rays, light.skyIndex, rules, counts);
    else
        scene.TraceToLight(rays, rules, counts);
    arrivals.live = rays.live;
    arrivals.tinted = rays.tinted;
    if (rays.tinted)
        arrivals.tint = rays.tint;
}

} // namespace

ContributionCounts &ContributionCounts::operator+=(const ContributionCounts &o) {
    rays += o.rays, pairs += o.pairs, skippedFacing += o.skippedFacing, skippedPvs += o.skippedPvs;
    skippedFaint += o.skippedFaint, skippedMoments += o.skippedMoments, skippedProbes += o.skippedProbes;
    skippedCoarse += o.skippedCoarse, refined += o.refined;
    return *this;
}

void LightPlaces::Add(const Vec3f &at, const Vec3f &raysFrom, int clusterAt, std::uint32_t indexAt) {
    position.Set(count, at);
    rayOrigin.Set(count, raysFrom);
    cluster[count] = clusterAt;
    index[count] = indexAt;
    wanted[count] = -1;
    ++count;
}

bool LightContributionToPoint(const Light &light, float weight, const ContributionSettings &settings,
                              const LightScene &scene, LightPlaces &places, Arrivals &arrivals,
                              ContributionCounts &counts) {
    arrivals.live = InSight(light, settings, places, counts);
    arrivals.tinted = false;
    if (!arrivals.live.Any())
        return false;
    const bool exact = settings.pass == LightPass::GridSH;
    if (exact && light.type == LightType::Area)
        return AreaContribution(light, weight, settings, scene, places, arrivals, counts).Add(arrivals.live);
    const int inSight = arrivals.live.Count();
    Lanes distance;
    Unshadowed(light, settings, places, arrivals, distance);
    const int inReach = arrivals.live.Count();
    counts.skippedFacing += std::uint64_t(inSight - inReach);
    if (inReach == 0)
        return false;
    if (light.type == LightType::Area && !TakeFaint(settings.faint, Strongest(arrivals), places, weight)) {
        counts.skippedFaint += std::uint64_t(inReach);
        return false;
    }
    Trace(light, settings, scene, places, distance, arrivals, counts);
    if (!arrivals.live.Any())
        return false;
    for (float &add : arrivals.add)
        add *= weight;
    if (exact)
        DirectionMoments(arrivals, settings.radiance);
    return true;
}

bool TakeFaint(float faint, float strongest, LightPlaces &places, float &weight) {
    const float light = strongest * weight;
    if (light >= faint)
        return true;
    places.collected += light;
    if (places.collected < faint)
        return false;
    places.collected -= faint;
    weight = faint / strongest;
    return true;
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
