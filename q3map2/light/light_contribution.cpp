// GPL-2.0-or-later. What one light gives to places of a light grid.
#include "q3map2/light/light_contribution.h"

#include "q3map2/light/light_area.h"
#include "q3map2/light/light_formfactor.h"
#include "q3map2/light/light_terms.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// Byte scale; far under what a byte can show.
constexpr float kFarError = 1.0f / 256;
/// Dimmer lights may go by coarse visibility. Byte scale.
constexpr float kDim = 1;

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

/// Direction and distance to the light; ends places beyond its reach.
Q3_VECTOR void AimAt(const Light &light, const LightPlaces &places, Arrivals &arrivals) {
    const Vec3f from = light.bounds.mins, to = light.bounds.maxs;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float px = places.position.x[i], py = places.position.y[i], pz = places.position.z[i];
        const float x = light.origin.x - px, y = light.origin.y - py, z = light.origin.z - pz;
        const float d = std::sqrt(x * x + y * y + z * z), divisor = d > 0 ? d : 1;
        arrivals.distance[i] = d;
        arrivals.direction.x[i] = x / divisor;
        arrivals.direction.y[i] = y / divisor;
        arrivals.direction.z[i] = z / divisor;
        const bool inside = (px >= from.x) & (py >= from.y) & (pz >= from.z) & (px <= to.x) & (py <= to.y) &
                            (pz <= to.z) & (d <= light.envelope);
        arrivals.live[i] = inside ? arrivals.live[i] : 0;
    }
}

/// Falloff of point lights and spotlights.
Q3_VECTOR void PointAdd(const Light &light, Arrivals &arrivals) {
    const Lanes &distance = arrivals.distance;
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
void Unshadowed(const Light &light, const ContributionSettings &settings, const LightPlaces &places,
                Arrivals &arrivals) {
    if (light.type == LightType::Sun) {
        arrivals.add.fill(light.photons);
        arrivals.direction.Fill(-light.normal);
        arrivals.distance.fill(kFar);
    } else {
        AimAt(light, places, arrivals);
        if (light.type != LightType::Area)
            PointAdd(light, arrivals);
        else
            for (std::size_t i = 0; i < kPacketSize; ++i)
                arrivals.add[i] = arrivals.live[i] == 0
                                      ? 0
                                      : LegacyAreaAdd(light, places.position[i], arrivals.direction[i],
                                                      arrivals.distance[i], settings);
    }
    const float least = light.fast && light.type != LightType::Sun ? light.tolerance : 0;
    for (std::size_t i = 0; i < kPacketSize; ++i)
        arrivals.live[i] = arrivals.add[i] > least ? arrivals.live[i] : 0;
}

/// Moments of light from one direction; from everywhere alike in the light itself, where the direction is zero.
Q3_VECTOR void DirectionMoments(Arrivals &arrivals, bool radiance) {
    const float s0 = float(kShC0) * (radiance ? 1 : float(kCosineLobe[0]));
    const float s1 = float(kShC1) * (radiance ? 1 : float(kCosineLobe[1]));
    const float band2 = radiance ? 1 : float(kCosineLobe[4]);
    const float s2 = float(kShC2) * band2, s3 = float(kShC3) * band2, s4 = float(kShC4) * band2;
    auto &m = arrivals.moments;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float x = arrivals.direction.x[i], y = arrivals.direction.y[i], z = arrivals.direction.z[i];
        const float add = arrivals.live[i] != 0 ? arrivals.add[i] : 0;
        m[0][i] = s0 * add;
        m[1][i] = s1 * y * add;
        m[2][i] = s1 * z * add;
        m[3][i] = s1 * x * add;
        m[4][i] = s2 * (x * y) * add;
        m[5][i] = s2 * (y * z) * add;
        m[6][i] = s3 * (2 * z * z - x * x - y * y) * add; // 3 z^2 - 1, and 0 where there is no direction
        m[7][i] = s2 * (x * z) * add;
        m[8][i] = s4 * (x * x - y * y) * add;
    }
}

Q3_VECTOR float Strongest(const Arrivals &arrivals) {
    float strongest = 0;
    for (std::size_t i = 0; i < kPacketSize; ++i)
        strongest = std::max(strongest, arrivals.live[i] != 0 ? arrivals.add[i] : 0);
    return strongest;
}

/// Delta lights, and area lights as the legacy grid takes them: one ray each.
class DeltaContribution {
  public:
    DeltaContribution(const Light &light, float weight, const ContributionSettings &settings, const LightScene &scene,
                      ContributionCounts &counts)
        : light_(light), weight_(weight), settings_(settings), scene_(scene), counts_(counts),
          exact_(settings.pass == LightPass::GridSH) {}

    /// Sets what arrives without shadows; afterwards live places have rays to trace.
    void Prepare(LightPlaces &places, Arrivals &arrivals) {
        const int inSight = arrivals.live.Count();
        Unshadowed(light_, settings_, places, arrivals);
        const int inReach = arrivals.live.Count();
        counts_.skippedFacing += std::uint64_t(inSight - inReach);
        float weight = weight_;
        if (light_.type == LightType::Area && inReach > 0) {
            if (!TakeFaint(settings_.faint, Strongest(arrivals), places, weight)) {
                counts_.skippedFaint += std::uint64_t(inReach);
                arrivals.live = {};
            }
        }
        for (float &add : arrivals.add)
            add *= weight;
    }
    /// Whether coarse visibility is good enough for the light.
    bool Dim(std::span<const Arrivals> arrivals) const {
        if (!exact_ || !settings_.skip.coarse)
            return false;
        const float color = MaxComponent(Max(light_.color, -light_.color)) * settings_.samples;
        return std::all_of(arrivals.begin(), arrivals.end(),
                           [&](const Arrivals &one) { return Strongest(one) * color < kDim; });
    }
    /// Rays from all live places.
    void Trace(const LightPlaces &places, Arrivals &arrivals) {
        if (!arrivals.live.Any())
            return;
        RayPacket rays;
        rays.origin = places.rayOrigin;
        rays.direction = arrivals.direction;
        rays.distance = arrivals.distance;
        rays.live = arrivals.live;
        Cast(rays);
        arrivals.live = rays.live;
        arrivals.tinted = rays.tinted;
        if (rays.tinted)
            arrivals.tint = rays.tint;
    }
    /// Rays from a few places of each block first, and from the others where those differ.
    void TraceCoarse(std::span<const LightPlaces> blocks, std::span<Arrivals> arrivals);
    void Finish(Arrivals &arrivals) const {
        if (exact_ && arrivals.live.Any())
            DirectionMoments(arrivals, settings_.radiance);
    }

  private:
    /// Places of a full block that are spread over all its axes.
    static constexpr std::array<std::size_t, 4> kSpread = {0, 5, 10, 15};
    static constexpr std::size_t kPerPacket = kPacketSize / kSpread.size();

    void Cast(RayPacket &rays) {
        if (light_.type == LightType::Sun)
            scene_.TraceToSky(rays, light_.skyIndex, exact_ ? ShadowRules::Exact : ShadowRules::LegacyGrid, counts_);
        else
            scene_.TraceToLight(rays, exact_ ? ShadowRules::Exact : ShadowRules::LegacyGrid, counts_);
    }

    const Light &light_;
    float weight_;
    const ContributionSettings &settings_;
    const LightScene &scene_;
    ContributionCounts &counts_;
    bool exact_;
};

void DeltaContribution::TraceCoarse(std::span<const LightPlaces> blocks, std::span<Arrivals> arrivals) {
    for (std::size_t first = 0; first < blocks.size(); first += kPerPacket) {
        const std::size_t count = std::min(kPerPacket, blocks.size() - first);
        RayPacket rays;
        for (std::size_t i = 0; i < count * kSpread.size(); ++i) {
            const std::size_t block = first + i / kSpread.size(), lane = kSpread[i % kSpread.size()];
            rays.origin.Set(i, blocks[block].rayOrigin[lane]);
            rays.direction.Set(i, arrivals[block].direction[lane]);
            rays.distance[i] = arrivals[block].distance[lane];
            rays.live[i] = arrivals[block].live[lane];
        }
        Cast(rays);
        for (std::size_t block = first; block < first + count; ++block) {
            const std::int32_t *seen = rays.live.data() + (block - first) * kSpread.size();
            int asked = 0, clear = 0;
            for (std::size_t i = 0; i < kSpread.size(); ++i)
                asked -= arrivals[block].live[kSpread[i]], clear -= seen[i];
            const bool alike = asked == int(kSpread.size()) && (clear == 0 || clear == asked) && !rays.tinted;
            if (!alike) {
                Trace(blocks[block], arrivals[block]);
                continue;
            }
            counts_.skippedCoarse += std::uint64_t(arrivals[block].live.Count() - asked);
            if (clear == 0)
                arrivals[block].live = {};
        }
    }
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
    oneCluster = oneCluster && clusterAt == cluster[0];
    ++count;
}

void LightContributionToPoint(const Light &light, float weight, const ContributionSettings &settings,
                              const LightScene &scene, std::span<LightPlaces> blocks, std::span<Arrivals> arrivals,
                              ContributionCounts &counts) {
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        arrivals[i].live = settings.sunOnly && light.type != LightType::Sun
                               ? LaneMask{}
                               : InSight(light, settings.skip.pvs, blocks[i], counts);
        arrivals[i].tinted = false;
    }
    if (light.type == LightType::Area && settings.pass == LightPass::GridSH) {
        for (std::size_t i = 0; i < blocks.size(); ++i)
            if (arrivals[i].live.Any())
                AreaContribution(light, weight, settings, scene, blocks[i], arrivals[i], counts).Add();
        return;
    }
    DeltaContribution delta(light, weight, settings, scene, counts);
    for (std::size_t i = 0; i < blocks.size(); ++i)
        if (arrivals[i].live.Any())
            delta.Prepare(blocks[i], arrivals[i]);
    if (delta.Dim(arrivals.first(blocks.size())))
        delta.TraceCoarse(blocks, arrivals);
    else
        for (std::size_t i = 0; i < blocks.size(); ++i)
            delta.Trace(blocks[i], arrivals[i]);
    for (Arrivals &one : arrivals.first(blocks.size()))
        delta.Finish(one);
}

bool TakeFaint(float faint, float strongest, float &collected, float &weight) {
    const float light = strongest * weight;
    if (light >= faint)
        return true;
    collected += light;
    if (collected < faint)
        return false;
    collected -= faint;
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
