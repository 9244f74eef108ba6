// GPL-2.0-or-later. What one light gives to receivers of a light grid.
#include "q3map2/light/transfer/light_contribution.h"

#include "q3map2/light/batch/form_factor.h"
#include "q3map2/light/scene/sky_beam.h"
#include "q3map2/light/transfer/light_area.h"
#include "q3map2/light/transfer/light_terms.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>

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
float LegacyAreaAdd(const Light &light, const Vec3f &p, const Vec3f &u, float d, const LightSettings &settings) {
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

/// Direction and distance to the light; ends receivers beyond its reach.
Q3_VECTOR void AimAt(const Light &light, const ReceiverBatch &receivers, IncidentLight &incident) {
    const Vec3f from = light.bounds.mins, to = light.bounds.maxs;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float px = receivers.position.x[i], py = receivers.position.y[i], pz = receivers.position.z[i];
        const float x = light.origin.x - px, y = light.origin.y - py, z = light.origin.z - pz;
        const float d = std::sqrt(x * x + y * y + z * z), divisor = d > 0 ? d : 1;
        incident.distance[i] = d;
        incident.direction.x[i] = x / divisor;
        incident.direction.y[i] = y / divisor;
        incident.direction.z[i] = z / divisor;
        const bool inside = (px >= from.x) & (py >= from.y) & (pz >= from.z) & (px <= to.x) & (py <= to.y) &
                            (pz <= to.z) & (d <= light.envelope);
        incident.live[i] = inside ? incident.live[i] : 0;
    }
}

/// Falloff of point lights and spotlights.
Q3_VECTOR void PointAdd(const Light &light, IncidentLight &incident) {
    const Lanes &distance = incident.distance;
    const float extra2 = light.extraDist * light.extraDist;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float d = std::max(kNearest, std::sqrt(distance[i] * distance[i] + extra2));
        incident.add[i] = light.linear ? light.photons * kLinearScale - d * light.fade : light.photons / (d * d);
    }
    if (light.type != LightType::Spot)
        return;
    for (std::size_t i = 0; i < kPacketSize; ++i)
        if (incident.live[i] != 0 && incident.add[i] > 0)
            incident.add[i] *= ConeShare(light, incident.direction[i] * distance[i]);
}

/// Light of suns without shadows.
Q3_VECTOR void SunArrives(const Light &light, float add, IncidentLight &incident) {
    incident.add.fill(add);
    incident.direction.Fill(-light.normal);
    incident.distance.fill(kSunDistance);
}

/// Light of others without shadows.
void Unshadowed(const Light &light, const LightSettings &settings, const ReceiverBatch &receivers,
                IncidentLight &incident) {
    AimAt(light, receivers, incident);
    if (light.type != LightType::Area)
        PointAdd(light, incident);
    else
        for (std::size_t i = 0; i < kPacketSize; ++i)
            incident.add[i] = incident.live[i] == 0 ? 0
                                                    : LegacyAreaAdd(light, receivers.position[i], incident.direction[i],
                                                                    incident.distance[i], settings);
}

/// Ends receivers that get at most `least`, which is not negative. What the others get at most.
Q3_VECTOR float CullFaint(float least, IncidentLight &incident) {
    std::int32_t strongest = 0;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const std::int32_t kept = (incident.live[i] != 0) & (incident.add[i] > least) ? -1 : 0;
        incident.live[i] = kept;
        strongest = std::max(strongest, OrderedBits(incident.add[i]) & kept);
    }
    return std::bit_cast<float>(strongest);
}

/// Moments of light from one direction; from everywhere alike in the light itself, where the direction is zero.
Q3_VECTOR void DirectionMoments(IncidentLight &incident, bool radiance) {
    const float s0 = float(kShC0) * (radiance ? 1 : float(kCosineLobe[0]));
    const float s1 = float(kShC1) * (radiance ? 1 : float(kCosineLobe[1]));
    const float band2 = radiance ? 1 : float(kCosineLobe[4]);
    const float s2 = float(kShC2) * band2, s3 = float(kShC3) * band2, s4 = float(kShC4) * band2;
    auto &m = incident.shCoeffs;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float x = incident.direction.x[i], y = incident.direction.y[i], z = incident.direction.z[i];
        const float add = incident.live[i] != 0 ? incident.add[i] : 0;
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

/// Delta lights, and area lights as the legacy grid takes them: one ray each.
class DeltaContribution {
  public:
    DeltaContribution(const Light &light, float weight, const LightSettings &settings, const LightScene &scene,
                      std::span<ReceiverBatch> blocks, std::span<IncidentLight> incident, ContributionCounts &counts)
        : light_(light), weight_(weight), settings_(settings), scene_(scene), blocks_(blocks), incident_(incident),
          counts_(counts), exact_(settings.pass == LightPass::GridSH) {}

    void Add() {
        if (light_.type == LightType::Sun)
            AimAtSky();
        float strongest = 0;
        for (std::size_t block = 0; block < blocks_.size(); ++block)
            if (incident_[block].live.Any())
                strongest = std::max(strongest, Prepare(block));
        if (Dim(strongest))
            TraceCoarse();
        else
            for (std::size_t block = 0; block < blocks_.size(); ++block)
                Trace(block, incident_[block].live.Bits());
        Flush();
        for (IncidentLight &one : incident_)
            if (exact_ && one.live.Any())
                DirectionMoments(one, settings_.radiance);
    }

  private:
    /// Receivers of a full block that are spread over all its axes.
    static constexpr std::array<std::size_t, 4> kCoarseLanes = {0, 5, 10, 15};
    static constexpr unsigned kCoarseLaneBits = 1u << 0 | 1u << 5 | 1u << 10 | 1u << 15;
    static constexpr std::size_t kPerPacket = kPacketSize / kCoarseLanes.size();

    float Prepare(std::size_t block);
    /// Whether coarse visibility is good enough for a light that gives at most `strongest`.
    bool Dim(float strongest) const {
        return exact_ && settings_.skip.coarse &&
               strongest * MaxComponent(Max(light_.color, -light_.color)) * settings_.samples < kDim;
    }
    void AimAtSky();
    void Cast(RayPacket &rays) {
        const ShadowRules rules = exact_ ? ShadowRules::Exact : ShadowRules::LegacyGrid;
        if (light_.type == LightType::Sun)
            scene_.TraceToSky(rays, light_.skyIndex, rules, counts_, beam_ ? &*beam_ : nullptr);
        else
            scene_.TraceToLight(rays, rules, counts_);
    }
    void SetRay(std::size_t ray, std::size_t block, std::size_t lane, RayPacket &rays) const {
        rays.origin.Set(ray, blocks_[block].rayOrigin[lane]);
        rays.direction.Set(ray, incident_[block].direction[lane]);
        rays.distance[ray] = incident_[block].distance[lane];
        rays.live[ray] = -1;
    }
    void TraceFull(std::size_t block);
    void Trace(std::size_t block, unsigned lanes);
    void Flush();
    void TraceCoarse();
    void TraceCoarseProbes(std::span<const std::size_t> blocks);

    const Light &light_;
    float weight_;
    const LightSettings &settings_;
    const LightScene &scene_;
    std::span<ReceiverBatch> blocks_;
    std::span<IncidentLight> incident_;
    ContributionCounts &counts_;
    bool exact_;
    std::optional<SkyBeam> beam_; ///< all rays of a sun
    /// Rays of blocks that do not fill a packet on their own wait here, with the place that each is from.
    RayPacket waiting_;
    std::array<std::uint32_t, kPacketSize> from_;
    std::size_t waitingCount_ = 0;
};

void DeltaContribution::AimAtSky() {
    const SkyFaces *skies = scene_.FewSkies();
    if (!skies)
        return;
    Boundsf box;
    for (const ReceiverBatch &receivers : blocks_)
        box.Add(receivers.rayOrigins);
    beam_.emplace(*skies, -light_.normal, box);
}

/// Sets what arrives without shadows; afterwards live receivers have rays to trace. What they get at most.
float DeltaContribution::Prepare(std::size_t block) {
    ReceiverBatch &receivers = blocks_[block];
    IncidentLight &incident = incident_[block];
    if (light_.type == LightType::Sun) {
        const float add = light_.photons * weight_;
        SunArrives(light_, add, incident);
        if (!(add > 0))
            incident.live = {};
        return add;
    }
    const int inSight = incident.live.Count();
    Unshadowed(light_, settings_, receivers, incident);
    const float strongest = CullFaint(light_.fast ? light_.tolerance : 0, incident);
    const int inReach = incident.live.Count();
    counts_.skippedFacing += std::uint64_t(inSight - inReach);
    float weight = weight_;
    if (light_.type == LightType::Area && inReach > 0 &&
        !SelectFaintLight(settings_.faint, strongest, receivers.faintResidual, weight)) {
        counts_.skippedFaint += std::uint64_t(inReach);
        incident.live = {};
        return 0;
    }
    if (weight != 1)
        for (float &add : incident.add)
            add *= weight;
    return strongest * weight;
}

/// Rays from all receivers of a block.
void DeltaContribution::TraceFull(std::size_t block) {
    IncidentLight &incident = incident_[block];
    RayPacket rays;
    rays.origin = blocks_[block].rayOrigin;
    rays.direction = incident.direction;
    rays.distance = incident.distance;
    rays.live = incident.live;
    Cast(rays);
    incident.live = rays.live;
    incident.tinted = rays.tinted;
    if (rays.tinted)
        incident.tint = rays.tint;
}

/// Rays from those receivers of a block, by bit; some of them later, together with those of other blocks.
void DeltaContribution::Trace(std::size_t block, unsigned lanes) {
    if (lanes == kAllLanes)
        return TraceFull(block);
    for (; lanes != 0; lanes &= lanes - 1) {
        const auto lane = std::size_t(std::countr_zero(lanes));
        SetRay(waitingCount_, block, lane, waiting_);
        from_[waitingCount_] = std::uint32_t(block * kPacketSize + lane);
        if (++waitingCount_ == kPacketSize)
            Flush();
    }
}

/// Traces the rays that wait.
void DeltaContribution::Flush() {
    if (waitingCount_ == 0)
        return;
    for (std::size_t ray = waitingCount_; ray < kPacketSize; ++ray)
        waiting_.live[ray] = 0;
    Cast(waiting_);
    for (std::size_t ray = 0; ray < waitingCount_; ++ray) {
        IncidentLight &incident = incident_[from_[ray] / kPacketSize];
        const std::size_t lane = from_[ray] % kPacketSize;
        incident.live[lane] = waiting_.live[ray];
        if (waiting_.tinted && waiting_.live[ray] != 0) {
            if (!incident.tinted)
                incident.tint.Fill({1, 1, 1});
            incident.tinted = true;
            incident.tint.Set(lane, waiting_.tint[ray]);
        }
    }
    waitingCount_ = 0;
}

/// Rays from a few receivers of each block first, and from the others where those differ.
void DeltaContribution::TraceCoarse() {
    std::array<std::size_t, kPerPacket> asked;
    std::size_t count = 0;
    for (std::size_t block = 0; block < blocks_.size(); ++block) {
        const unsigned live = incident_[block].live.Bits();
        if ((live & kCoarseLaneBits) != kCoarseLaneBits) {
            Trace(block, live);
            continue;
        }
        asked[count++] = block;
        if (count == kPerPacket)
            TraceCoarseProbes(asked), count = 0;
    }
    if (count > 0)
        TraceCoarseProbes(std::span(asked).first(count));
}

void DeltaContribution::TraceCoarseProbes(std::span<const std::size_t> blocks) {
    RayPacket rays;
    for (std::size_t ray = 0; ray < blocks.size() * kCoarseLanes.size(); ++ray)
        SetRay(ray, blocks[ray / kCoarseLanes.size()], kCoarseLanes[ray % kCoarseLanes.size()], rays);
    Cast(rays);
    for (std::size_t n = 0; n < blocks.size(); ++n) {
        const std::int32_t *seen = rays.live.data() + n * kCoarseLanes.size();
        IncidentLight &incident = incident_[blocks[n]];
        const unsigned live = incident.live.Bits();
        int clear = 0;
        bool tinted = false;
        for (std::size_t i = 0; i < kCoarseLanes.size(); ++i) {
            clear -= seen[i];
            tinted = tinted || (rays.tinted && (seen[i] & rays.filtered[n * kCoarseLanes.size() + i]) != 0);
        }
        if (tinted) {
            Trace(blocks[n], live);
            continue;
        }
        if (clear != 0 && clear != int(kCoarseLanes.size())) {
            for (std::size_t i = 0; i < kCoarseLanes.size(); ++i)
                incident.live[kCoarseLanes[i]] = seen[i];
            Trace(blocks[n], live & ~kCoarseLaneBits);
            continue;
        }
        counts_.skippedCoarse += std::uint64_t(std::popcount(live & ~kCoarseLaneBits));
        if (clear == 0)
            incident.live = {};
    }
}

} // namespace

ContributionCounts &ContributionCounts::operator+=(const ContributionCounts &o) {
    rays += o.rays, pairs += o.pairs, skippedFacing += o.skippedFacing, skippedPvs += o.skippedPvs;
    skippedFaint += o.skippedFaint, skippedMoments += o.skippedMoments, skippedProbes += o.skippedProbes;
    skippedCoarse += o.skippedCoarse, refined += o.refined;
    return *this;
}

void ReceiverBatch::Add(const Vec3f &at, const Vec3f &raysFrom, int clusterAt, std::uint32_t indexAt) {
    position.Set(count, at);
    rayOrigin.Set(count, raysFrom);
    rayOrigins.Add(raysFrom);
    clusters.Add(count, clusterAt);
    index[count] = indexAt;
    wanted[count] = -1;
    ++count;
}

void LightContributionToPoint(const Light &light, float weight, const LightSettings &settings, const LightScene &scene,
                              std::span<ReceiverBatch> blocks, std::span<IncidentLight> incident,
                              ContributionCounts &counts) {
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        incident[i].live = settings.sunOnly && light.type != LightType::Sun
                               ? LaneMask{}
                               : InSight(light, settings.skip.pvs, blocks[i], counts);
        incident[i].tinted = false;
    }
    if (light.type == LightType::Area && settings.pass == LightPass::GridSH) {
        AreaContribution area(light, weight, settings, scene, counts);
        for (std::size_t i = 0; i < blocks.size(); ++i)
            if (incident[i].live.Any())
                area.Add(blocks[i], incident[i]);
        return;
    }
    DeltaContribution(light, weight, settings, scene, blocks, incident.first(blocks.size()), counts).Add();
}

bool SelectFaintLight(float faint, float strongest, float &faintResidual, float &weight) {
    const float light = strongest * weight;
    if (light >= faint)
        return true;
    faintResidual += light;
    if (faintResidual < faint)
        return false;
    faintResidual -= faint;
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
