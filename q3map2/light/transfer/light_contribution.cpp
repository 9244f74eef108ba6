// GPL-2.0-or-later. Light of one source at points of the light grids.
#include "q3map2/light/transfer/light_contribution.h"

#include "libs/sh/sh.h"
#include "q3map2/light/batch/form_factor.h"
#include "q3map2/light/batch/receivers.h"
#include "q3map2/light/sources/falloff.h"
#include "q3map2/light/transfer/light_area.h"
#include "q3map2/light/transfer/light_kernel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace q3 {

// ---- Many faint lights represented by a few of them ----

bool SelectFaintLight(float faint, float bound, float &residual, float &weight) {
    const float light = bound * weight;
    if (light >= faint)
        return true;
    residual += light;
    if (residual < faint)
        return false;
    residual -= faint;
    weight = faint / bound;
    return true;
}

float LightBound(const Light &light, const Boundsf &box) {
    const float color = MaxAbsComponent(light.color);
    if (light.type == LightType::Sun)
        return color * light.photons;
    if (light.type != LightType::Area)
        return color * std::max(0.0f, Falloff(light).At(box.Distance(light.origin)));
    const AreaShape &shape = light.shape;
    const float d = box.Distance(shape.center) - shape.radius;
    const Vec3f n(shape.normal), half = (box.maxs - box.mins) * 0.5f;
    const float reach = std::abs(n.x) * half.x + std::abs(n.y) * half.y + std::abs(n.z) * half.z;
    const float height = std::abs(Dot(n, box.Center()) - float(shape.dist)) + reach;
    const float fraction = d > 0 ? shape.area * std::min(1.0f, height / d) / (std::numbers::pi_v<float> * d * d) : 1;
    return color * light.radiosity * std::min(1.0f, fraction);
}

// ---- Light of one source at points of the light grids ----

namespace {

/// Lights dimmer than this may use coarse visibility. Byte scale.
constexpr float kDim = 1;

/// Receivers outside the light's bounds or beyond its envelope are live no longer.
void CullReach(const Light &light, const Lanes3 &position, ProbeIncidentLight &incident) {
    Vectorize([&]() Q3_INLINE {
        const Vec3f from = light.bounds.mins, to = light.bounds.maxs;
        const float envelope = light.envelope;
        for (const std::size_t i : kEachLane) {
            const float x = position.x[i], y = position.y[i], z = position.z[i];
            const float d = incident.distance[i];
            const bool inside = (x >= from.x) & (y >= from.y) & (z >= from.z) & (x <= to.x) & (y <= to.y) &
                                (z <= to.z) & (d <= envelope);
            incident.live[i] = inside ? incident.live[i] : 0;
        }
    });
}

/// strength = |form factor| radiosity; 0 behind a one-sided light.
void SetFromFormFactors(const Light &light, const Lanes &heights, const Lanes &formFactors,
                        ProbeIncidentLight &incident) {
    Vectorize([&]() Q3_INLINE {
        const bool twoSided = light.twoSided;
        const float radiosity = light.radiosity;
        for (const std::size_t i : kEachLane) {
            const float height = heights[i], factor = formFactors[i];
            const float front = height < -kAreaBehind ? 0 : std::max(factor, 0.0f);
            incident.strength[i] = (twoSided ? std::abs(factor) : front) * radiosity;
        }
    });
}

/// An area light by the formula of NetRadiant's q3map2: the form factor of a receiver that faces the light's center.
void SetLegacyAreaLight(const Light &light, const ReceiverBatch &receivers, ProbeIncidentLight &incident) {
    Lanes heights, formFactors;
    Lanes3 pushed;
    AreaHeights(light, receivers.position, heights, pushed);
    FormFactors(pushed, incident.direction, light.polygon, formFactors);
    SetFromFormFactors(light, heights, formFactors, incident);
}

/// Sets the unshadowed light of a source other than a sun.
void SetUnshadowedLight(const Light &light, const LightSettings &settings, const ReceiverBatch &receivers,
                        ProbeIncidentLight &incident) {
    AimAt(light.origin, receivers.position, incident);
    CullReach(light, receivers.position, incident);
    if (!incident.live.Any())
        return;
    if (light.type == LightType::Area && !settings.pointAreas)
        return SetLegacyAreaLight(light, receivers, incident);
    Lanes angleFactor;
    angleFactor.fill(1);
    SetPointLight(light, angleFactor, incident);
}

/// Projects light from one direction u on the SH basis: coefficient k is strength * Y[k](u) times the convolution
/// factor of its band. At the light's own position u is zero: light from all directions, band 0 alone.
void ProjectDirections(ProbeIncidentLight &incident, bool radiance) {
    Vectorize([&, radiance]() Q3_INLINE {
        // s0 to s4: SHBasis's constants times the factors; s2 is of xy, yz and xz, s3 of 3 z^2 - 1, s4 of x^2 - y^2.
        const float s0 = float(kSHC0) * float(StoredFactor(0, radiance));
        const float s1 = float(kSHC1) * float(StoredFactor(1, radiance));
        const float band2 = float(StoredFactor(4, radiance));
        const float s2 = float(kSHC2) * band2, s3 = float(kSHC3) * band2, s4 = float(kSHC4) * band2;
        auto &c = incident.shCoeffs;
        for (const std::size_t i : kEachLane) {
            const float x = incident.direction.x[i], y = incident.direction.y[i], z = incident.direction.z[i];
            const float strength = incident.live[i] != 0 ? incident.strength[i] : 0;
            c[0][i] = s0 * strength;
            c[1][i] = s1 * y * strength;
            c[2][i] = s1 * z * strength;
            c[3][i] = s1 * x * strength;
            c[4][i] = s2 * (x * y) * strength;
            c[5][i] = s2 * (y * z) * strength;
            c[6][i] = s3 * (2 * z * z - x * x - y * y) * strength; // 3 z^2 - 1, but 0 where u is zero
            c[7][i] = s2 * (x * z) * strength;
            c[8][i] = s4 * (x * x - y * y) * strength;
        }
    });
}

/// The light of receivers that are live: before parts are taken, and before rays are traced.
void SetUnshadowed(ProbeIncidentLight &incident) {
    for (const std::size_t i : kEachLane)
        incident.unshadowed[i] = incident.live[i] != 0 ? incident.strength[i] : 0;
}

/// What arrived of it: nothing at receivers that are live no longer.
void SetVisible(ProbeIncidentLight &incident) {
    for (const std::size_t i : kEachLane) {
        const float tint = incident.tinted ? (incident.tint.x[i] + incident.tint.y[i] + incident.tint.z[i]) / 3 : 1;
        incident.visible[i] = incident.live[i] != 0 ? tint : 0;
    }
}

/// Reduces `strength` to the part of the light that the pass takes; receivers at which that is 0 are live no longer.
void ReduceToPart(const Light &light, const LightSettings &settings, ProbeIncidentLight &incident) {
    SetUnshadowed(incident);
    if (settings.part == LightPart::Whole)
        return;
    const float color = MaxAbsComponent(light.color);
    for (const std::size_t i : kEachLane) {
        incident.strength[i] *= FractionOfPart(settings.part, color * incident.strength[i], settings.weakBelow);
        incident.live[i] = incident.strength[i] > 0 ? incident.live[i] : 0;
        incident.unshadowed[i] = incident.live[i] != 0 ? incident.unshadowed[i] : 0;
    }
}

/// Lights that take one shadow ray a receiver: points, spots and suns, and area lights in the legacy grid.
class SingleRayLight {
  public:
    SingleRayLight(const Light &light, float weight, const LightSettings &settings, const LightScene &scene,
                   std::span<ReceiverBatch> batches, std::span<ProbeIncidentLight> incident, ContributionCounts &counts)
        : light_(light), weight_(weight), settings_(settings), scene_(scene), batches_(batches), incident_(incident),
          counts_(counts), isGridSH_(settings.pass == LightPass::GridSH), rays_(Trace{*this}) {}

    /// Sets `incident` of the live receivers; those that get nothing are live no longer.
    void Evaluate() {
        float strongest = 0;
        for (std::size_t batch = 0; batch < batches_.size(); ++batch)
            if (incident_[batch].live.Any())
                strongest = std::max(strongest, Prepare(batch));
        if (IsDim(strongest))
            TraceCoarse();
        else
            for (std::size_t batch = 0; batch < batches_.size(); ++batch)
                Queue(batch, incident_[batch].live.Bits());
        rays_.Flush();
        for (ProbeIncidentLight &one : incident_) {
            if (isGridSH_)
                SetVisible(one);
            if (isGridSH_ && one.live.Any())
                ProjectDirections(one, settings_.radiance);
        }
    }

  private:
    /// Lanes of a full batch, a block of 4 x 2 x 2 points with x fastest, that differ along all axes: the points
    /// (0, 0, 0), (1, 1, 0), (2, 0, 1) and (3, 1, 1).
    static constexpr unsigned kCoarseLanes = 1u << 0 | 1u << 5 | 1u << 10 | 1u << 15;

    /// The receiver of a queued ray.
    struct Receiver {
        std::size_t batch, lane;
    };
    struct Trace {
        SingleRayLight &light;
        void operator()(RayPacket &packet, std::span<const Receiver> receivers) const {
            light.Cast(packet);
            for (std::size_t ray = 0; ray < receivers.size(); ++ray)
                light.StoreResult(packet, ray, receivers[ray]);
        }
    };

    float Prepare(std::size_t batch);
    /// Whether coarse visibility is good enough for a light that gives at most `strongest`. More samples (-shsamples)
    /// ask for more quality, so the limit is lower with them.
    bool IsDim(float strongest) const {
        return isGridSH_ && settings_.skip.coarse &&
               strongest * MaxAbsComponent(light_.color) * settings_.samples < kDim;
    }
    void Cast(RayPacket &rays) const {
        if (!settings_.shadows)
            return;
        const ShadowRules rules = isGridSH_ ? ShadowRules::Exact : ShadowRules::LegacyGrid;
        if (light_.type == LightType::Sun)
            scene_.TraceToSky(rays, light_.skyIndex, rules, counts_);
        else
            scene_.TraceToLight(rays, rules, counts_);
    }
    void StoreResult(const RayPacket &rays, std::size_t ray, const Receiver &receiver) const;
    void Queue(std::size_t batch, unsigned lanes);
    void TraceCoarse();

    const Light &light_;
    float weight_;
    const LightSettings &settings_;
    const LightScene &scene_;
    std::span<ReceiverBatch> batches_;
    std::span<ProbeIncidentLight> incident_;
    ContributionCounts &counts_;
    bool isGridSH_;
    RayBatcher<Receiver, Trace> rays_;
};

/// Sets the unshadowed light; receivers still live need rays. Returns the greatest `strength` of one of them.
float SingleRayLight::Prepare(std::size_t batch) {
    ReceiverBatch &receivers = batches_[batch];
    ProbeIncidentLight &incident = incident_[batch];
    if (light_.type == LightType::Sun) {
        AimAtSun(light_, incident);
        incident.strength.fill(light_.photons * weight_);
        if (!(light_.photons * weight_ > 0))
            incident.live = {};
        ReduceToPart(light_, settings_, incident);
        return Strongest(incident);
    }
    const int inSight = incident.live.Count();
    SetUnshadowedLight(light_, settings_, receivers, incident);
    CullBelowTolerance(light_, incident);
    const int inReach = incident.live.Count();
    counts_.skippedUnlit += std::uint64_t(inSight - inReach);
    if (inReach == 0 || !ApplyFaintSelection(light_, settings_.faint, weight_, receivers, incident, counts_))
        return 0;
    ReduceToPart(light_, settings_, incident);
    return Strongest(incident);
}

/// Casts rays from the receivers of a batch with a bit in `lanes`: at once if they fill a packet, else queued to share
/// packets with other batches.
void SingleRayLight::Queue(std::size_t batch, unsigned lanes) {
    const ReceiverBatch &receivers = batches_[batch];
    ProbeIncidentLight &incident = incident_[batch];
    if (lanes == kAllLanes) {
        RayPacket rays;
        SetShadowRays(receivers, incident, rays);
        Cast(rays);
        return ApplyShadowRays(rays, incident);
    }
    for (; lanes != 0; lanes &= lanes - 1) {
        const auto lane = std::size_t(std::countr_zero(lanes));
        rays_.Add({batch, lane}, receivers.rayOrigin[lane], incident.direction[lane], incident.distance[lane]);
    }
}

/// Stores the result of a queued ray.
void SingleRayLight::StoreResult(const RayPacket &rays, std::size_t ray, const Receiver &receiver) const {
    ProbeIncidentLight &incident = incident_[receiver.batch];
    incident.live[receiver.lane] = rays.live[ray];
    if (!rays.tinted || rays.live[ray] == 0 || rays.filtered[ray] == 0)
        return;
    if (!incident.tinted)
        incident.tint.Fill({1, 1, 1});
    incident.tinted = true;
    incident.tint.Set(receiver.lane, rays.tint[ray]);
}

/// Casts rays from a few receivers of each batch, then from the rest of batches where these differ or see tinted light.
void SingleRayLight::TraceCoarse() {
    std::vector<unsigned> live;
    for (std::size_t batch = 0; batch < batches_.size(); ++batch) {
        live.push_back(incident_[batch].live.Bits());
        Queue(batch, (live[batch] & kCoarseLanes) == kCoarseLanes ? kCoarseLanes : live[batch]);
    }
    rays_.Flush();
    for (std::size_t batch = 0; batch < batches_.size(); ++batch) {
        const unsigned others = live[batch] & ~kCoarseLanes;
        if ((live[batch] & kCoarseLanes) != kCoarseLanes || others == 0)
            continue;
        const unsigned seen = incident_[batch].live.Bits() & kCoarseLanes;
        if (incident_[batch].tinted || (seen != 0 && seen != kCoarseLanes)) {
            Queue(batch, others);
            continue;
        }
        counts_.skippedCoarse += std::uint64_t(std::popcount(others));
        if (seen == 0)
            incident_[batch].live = {};
    }
}

} // namespace

void LightContributionToPoint(const Light &light, float weight, const LightSettings &settings, const LightScene &scene,
                              std::span<ReceiverBatch> batches, std::span<ProbeIncidentLight> incident,
                              ContributionCounts &counts) {
    for (std::size_t i = 0; i < batches.size(); ++i) {
        incident[i].live = settings.sunOnly && light.type != LightType::Sun
                               ? LaneMask{}
                               : InSight(light, settings.skip.pvs, batches[i], counts);
        incident[i].tinted = false;
        incident[i].unshadowed.fill(0);
    }
    if (light.type == LightType::Area && settings.pass == LightPass::GridSH) {
        AreaContribution area(light, weight, settings, scene, counts);
        for (std::size_t i = 0; i < batches.size(); ++i)
            if (incident[i].live.Any())
                area.Evaluate(batches[i], incident[i]);
        return;
    }
    SingleRayLight(light, weight, settings, scene, batches, incident.first(batches.size()), counts).Evaluate();
}

} // namespace q3
