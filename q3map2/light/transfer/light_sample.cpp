// GPL-2.0-or-later. Light of one source at luxels and vertices, and the directions that it comes from.
#include "q3map2/light/transfer/light_sample.h"

#include "q3map2/light/batch/form_factor.h"
#include "q3map2/light/sources/falloff.h"
#include "q3map2/light/transfer/light_kernel.h"
#include "q3map2/light/transfer/soft_light.h"

#include <algorithm>
#include <cmath>

namespace q3 {

// ---- Light of one source at luxels and vertices ----

namespace {

/// Half-Lambert light is 0 up to this cosine.
constexpr float kLeastHalfLambert = 0.001f;

/// A light and a batch of receivers, for all steps below.
struct SurfaceTransfer {
    const Light &light;
    const SurfaceLightSettings &settings;
    const SurfaceReceiverBatch &receivers;
    SurfaceIncidentLight &incident;
    Lanes cosine;      ///< between the normal and the direction to the light
    Lanes angleFactor; ///< of the angle of incidence
};

/// Sets cosine = N . u. Drops receivers at or beyond the envelope, and one-sided receivers that face away.
void CullByReachAndFacing(SurfaceTransfer &transfer) {
    Vectorize([&]() Q3_INLINE {
        const Lanes3 &n = transfer.receivers.normal, &u = transfer.incident.direction;
        const float envelope = transfer.light.envelope;
        const bool twoSided = transfer.receivers.twoSided;
        for (const std::size_t i : kEachLane) {
            const float cosine = u.x[i] * n.x[i] + u.y[i] * n.y[i] + u.z[i] * n.z[i];
            transfer.cosine[i] = cosine;
            const float d = transfer.incident.distance[i];
            const bool lit = (d < envelope) & (twoSided | (cosine >= 0));
            transfer.incident.live[i] = lit ? transfer.incident.live[i] : 0;
        }
    });
}

/// angleFactor = |cosine|, or ((1 + |cosine|) / 2)^2 with -lightanglehl. Light from behind on two-sided surfaces has no
/// direction.
void SetAngles(SurfaceTransfer &transfer) {
    Vectorize([&]() Q3_INLINE {
        const bool twoSided = transfer.receivers.twoSided, half = transfer.settings.halfLambert;
        for (const std::size_t i : kEachLane) {
            const float toLight = transfer.cosine[i];
            const bool behind = twoSided & (toLight < 0);
            const float cosine = behind ? -toLight : toLight;
            const float wrapped = 0.5f * std::min(cosine, 1.0f) + 0.5f;
            transfer.angleFactor[i] = !half ? cosine : cosine > kLeastHalfLambert ? wrapped * wrapped : 0;
            transfer.incident.undirected[i] = behind ? -1 : 0;
        }
    });
}

/// strength = photons angleFactor.
void SetSunLight(SurfaceTransfer &transfer) {
    Vectorize([&]() Q3_INLINE {
        const Lanes3 &n = transfer.receivers.normal;
        const Vec3f u = -transfer.light.normal;
        const float photons = transfer.light.photons;
        for (const std::size_t i : kEachLane)
            transfer.cosine[i] = u.x * n.x[i] + u.y * n.y[i] + u.z * n.z[i];
        AimAtSun(transfer.light, transfer.incident);
        SetAngles(transfer);
        for (const std::size_t i : kEachLane)
            transfer.incident.strength[i] = photons * transfer.angleFactor[i];
    });
}

/// angleFactor = 1 for lights without angle attenuation; then min(1, angleFactor / angleScale), if there is a scale.
void SetPointAngles(SurfaceTransfer &transfer) {
    if (transfer.light.angleAttenuation)
        SetAngles(transfer);
    else {
        transfer.angleFactor.fill(1);
        transfer.incident.undirected = {};
    }
    if (transfer.light.angleScale != 0)
        for (float &factor : transfer.angleFactor)
            factor = std::min(1.0f, factor / transfer.light.angleScale);
}

/// Drops receivers behind a one-sided area light or on its own surface. heights: over the light's plane.
void CullAreaSides(const Lanes &heights, SurfaceTransfer &transfer) {
    Vectorize([&]() Q3_INLINE {
        const Lanes3 &n = transfer.receivers.normal;
        const Vec3f facing = transfer.light.normal;
        const bool oneSided = !transfer.light.twoSided;
        for (const std::size_t i : kEachLane) {
            const float along = n.x[i] * facing.x + n.y[i] * facing.y + n.z[i] * facing.z;
            const float height = heights[i];
            const bool behind = oneSided & (height < -kAreaBehind);
            const bool onEmitter = (height > -kAreaOwnSide) & (along > kAreaOwnCosine);
            const bool hidden = (height < kAreaOwnSide) & (behind | onEmitter);
            transfer.incident.live[i] = hidden ? 0 : transfer.incident.live[i];
        }
    });
}

/// -faster: strength = falloff * (N . u) (-n_l . u), the two cosines of a small patch; sides as for form factors.
void SetAreaLightAsPoint(SurfaceTransfer &transfer) {
    Vectorize([&]() Q3_INLINE {
        const Lanes3 &u = transfer.incident.direction;
        const Vec3f facing = transfer.light.normal;
        const bool twoSided = transfer.receivers.twoSided, anySide = twoSided || transfer.light.twoSided;
        const Falloff falloff(transfer.light);
        for (const std::size_t i : kEachLane) {
            const float toLight = transfer.cosine[i];
            const bool behind = twoSided & (toLight < 0);
            const float cosine = behind ? -toLight : toLight;
            const float cosines = cosine * -(u.x[i] * facing.x + u.y[i] * facing.y + u.z[i] * facing.z);
            const bool turned = (cosines < 0) & anySide;
            transfer.incident.undirected[i] = (behind | turned) ? -1 : 0;
            transfer.incident.strength[i] =
                falloff.InverseSquare(transfer.incident.distance[i], turned ? -cosines : cosines);
        }
    });
}

/// strength = |form factor| radiosity. Negative form factors count if the receiver or the light is two-sided:
/// `flipped`.
void SetAreaLight(const Lanes &formFactors, SurfaceTransfer &transfer, LaneMask &flipped) {
    Vectorize([&]() Q3_INLINE {
        const bool anySide = transfer.receivers.twoSided || transfer.light.twoSided;
        const float radiosity = transfer.light.radiosity;
        for (const std::size_t i : kEachLane) {
            const float factor = formFactors[i], cosine = transfer.cosine[i];
            const bool flip = (factor < 0) & anySide;
            transfer.incident.strength[i] = (flip ? -factor : factor) * radiosity;
            transfer.incident.undirected[i] = (flip | (cosine < 0)) ? -1 : 0;
            flipped[i] = flip ? transfer.incident.live[i] : 0;
        }
    });
}

/// Aims flipped lanes 1 unit behind the light's surface: L' = L - 2 n_l, since its origin L is 1 unit in front.
void AimAtBack(const LaneMask &flipped, SurfaceTransfer &transfer) {
    Vectorize([&]() Q3_INLINE {
        SurfaceIncidentLight back;
        AimAt(transfer.light.origin - transfer.light.normal * 2, transfer.receivers.position, back);
        const float envelope = transfer.light.envelope;
        for (const std::size_t i : kEachLane) {
            const bool on = flipped[i] != 0;
            const float d = back.distance[i];
            transfer.incident.distance[i] = on ? d : transfer.incident.distance[i];
            transfer.incident.direction.x[i] = on ? back.direction.x[i] : transfer.incident.direction.x[i];
            transfer.incident.direction.y[i] = on ? back.direction.y[i] : transfer.incident.direction.y[i];
            transfer.incident.direction.z[i] = on ? back.direction.z[i] : transfer.incident.direction.z[i];
            transfer.incident.live[i] = (on & (d >= envelope)) ? 0 : transfer.incident.live[i];
        }
    });
}

void SetAreaLight(SurfaceTransfer &transfer) {
    Lanes heights;
    Lanes3 pushed;
    AreaHeights(transfer.light, transfer.receivers.position, heights, pushed);
    CullAreaSides(heights, transfer);
    if (!transfer.incident.live.Any())
        return;
    if (transfer.settings.pointAreas)
        return SetAreaLightAsPoint(transfer);
    Lanes formFactors;
    LaneMask flipped;
    FormFactors(pushed, transfer.receivers.normal, transfer.light.polygon, formFactors);
    SetAreaLight(formFactors, transfer, flipped);
    if (flipped.Any())
        AimAtBack(flipped, transfer);
}

/// Sets the unshadowed light; drops receivers that are out of reach, or on a side that gets no light.
void SetUnshadowedLight(SurfaceTransfer &transfer) {
    if (transfer.light.type == LightType::Sun)
        return SetSunLight(transfer);
    AimAt(transfer.light.origin, transfer.receivers.position, transfer.incident);
    CullByReachAndFacing(transfer);
    if (!transfer.incident.live.Any())
        return;
    if (transfer.light.type == LightType::Area)
        return SetAreaLight(transfer);
    SetPointAngles(transfer);
    SetPointLight(transfer.light, transfer.angleFactor, transfer.incident);
}

void TraceShadows(const Light &light, const SurfaceLightSettings &settings, const LightScene &scene,
                  const SurfaceReceiverBatch &receivers, SurfaceIncidentLight &incident, ContributionCounts &counts) {
    RayPacket rays;
    SetShadowRays(receivers, incident, rays);
    rays.ignoredProp = settings.ignoredProp;
    if (light.type == LightType::Sun)
        scene.TraceSurfaceToSky(rays, light.skyIndex, settings.receiveShadows, counts);
    else
        scene.TraceSurfaceToLight(rays, settings.receiveShadows, counts);
    ApplyShadowRays(rays, incident);
    incident.filtered = rays.filtered;
}

} // namespace

void LightContributionToSample(const Light &light, const SurfaceLightSettings &settings, const LightScene &scene,
                               SurfaceReceiverBatch &receivers, SurfaceIncidentLight &incident,
                               ContributionCounts &counts) {
    incident.tinted = false;
    incident.filtered = {};
    incident.live = {};
    const bool sun = light.type == LightType::Sun;
    if (!light.lightsSurfaces || (settings.sunOnly && !sun))
        return;
    if (light.type == LightType::Area && settings.HasSoftShadows())
        return SoftAreaLight(light, settings, scene, counts).Evaluate(receivers, incident);
    const bool traced = settings.TracesShadowsOf(light);
    incident.live = InSight(light, traced || !sun, receivers, counts);
    const int inSight = incident.live.Count();
    if (inSight == 0)
        return;
    SurfaceTransfer transfer{light, settings, receivers, incident, {}, {}};
    SetUnshadowedLight(transfer);
    CullBelowTolerance(light, incident);
    const int inReach = incident.live.Count();
    counts.skippedUnlit += std::uint64_t(inSight - inReach);
    if (inReach > 0 && ApplyFaintSelection(light, settings.faint, 1, receivers, incident, counts) && traced)
        TraceShadows(light, settings, scene, receivers, incident, counts);
    if (settings.directional && incident.live.Any())
        SetLightDirections(light, settings.pointAreas, receivers, transfer.cosine, transfer.angleFactor, incident);
}

// ---- Groups of samples ----

LightGroup::LightGroup(std::span<const Light *const> samples) : samples_(samples), color_(First().color) {
    const auto colored = [&](const Light *sample) { return sample->color != First().color; };
    colorsDiffer_ = std::ranges::any_of(samples, colored);
    if (!colorsDiffer_)
        return;
    color_ = {};
    for (const Light *sample : samples)
        color_ += sample->color / float(samples.size());
}

std::vector<LightGroup> LightGroupsOf(std::span<const Light *const> lights, const SurfaceLightSettings &settings) {
    std::vector<LightGroup> groups;
    for (std::size_t first = 0; first < lights.size();) {
        std::size_t count = 1;
        const Light &light = *lights[first];
        while (first + count < lights.size() && light.group >= 0 && lights[first + count]->group == light.group &&
               SoftSampledLight::CanGroup(light, settings))
            ++count;
        groups.emplace_back(lights.subspan(first, count));
        first += count;
    }
    return groups;
}

void GroupContributionToSample(const LightGroup &group, const SurfaceLightSettings &settings, const LightScene &scene,
                               SurfaceReceiverBatch &receivers, SurfaceIncidentLight &incident,
                               ContributionCounts &counts) {
    if (group.Samples().size() == 1)
        return LightContributionToSample(group.First(), settings, scene, receivers, incident, counts);
    SoftSampledLight(group, settings, scene, counts).Evaluate(receivers, incident);
}

// ---- The directions that the light of one source comes from, at receivers on surfaces ----

namespace {

/// Lower bound of cosines and form factors that are divided by.
constexpr float kLeastCosine = 1e-6f;

/// Directions of a light from one point. towardLight: light on a receiver that faces the light, divided by the light on
/// the receiver itself, L(1) / L(A).
void SetDirectionsToPoint(const Lanes &towardLight, const Lanes &cosine, SurfaceIncidentLight &incident) {
    Vectorize([&]() Q3_INLINE {
        LightDirections &to = incident.directions;
        for (const std::size_t i : kEachLane) {
            const float c = std::max(cosine[i], kLeastCosine);
            const float length = cosine[i] < 0 ? 0 : std::min(towardLight[i], 1 / c);
            to.vector.x[i] = incident.direction.x[i] * length;
            to.vector.y[i] = incident.direction.y[i] * length;
            to.vector.z[i] = incident.direction.z[i] * length;
            to.uniform[i] = std::max(0.0f, 1 - length * c);
            to.spread[i] = 1;
        }
    });
}

/// Directions of an area light. vectors: as set by FormFactorVectors.
void SetDirectionsToArea(const Lanes3 &vectors, const Lanes3 &normal, const LaneMask &undirected, LightDirections &to) {
    Vectorize([&]() Q3_INLINE {
        for (const std::size_t i : kEachLane) {
            const float x = vectors.x[i], y = vectors.y[i], z = vectors.z[i];
            const float formFactor = x * normal.x[i] + y * normal.y[i] + z * normal.z[i];
            const bool back = (formFactor < 0) | (undirected[i] != 0);
            const float scale = back ? 0 : 1 / std::max(formFactor, kLeastCosine);
            to.vector.x[i] = x * scale, to.vector.y[i] = y * scale, to.vector.z[i] = z * scale;
            to.uniform[i] = back ? 1.0f : 0.0f;
            // A cone of half angle a has an irradiance vector of length pi sin^2 a (here divided by pi) and a fluence
            // (solid angle) of 2 pi (1 - cos a): their ratio, the spread, is 2 / (1 + cos a).
            const float sine2 = std::min(1.0f, std::sqrt(x * x + y * y + z * z));
            to.spread[i] = 2 / (1 + std::sqrt(1 - sine2));
        }
    });
}

/// factor = L(1) / L(A) of a point light or spotlight.
void SetTowardLight(const Light &light, const Lanes &angleFactor, const Lanes &distance, Lanes &factor) {
    const Falloff falloff(light);
    for (const std::size_t i : kEachLane)
        factor[i] = falloff.At(distance[i]) / std::max(falloff.At(distance[i], angleFactor[i]), kLeastCosine);
}

} // namespace

void SetLightDirections(const Light &light, bool pointAreas, const SurfaceReceiverBatch &receivers, const Lanes &cosine,
                        const Lanes &angleFactor, SurfaceIncidentLight &incident) {
    Lanes factor;
    if (light.type == LightType::Area && !pointAreas) {
        Lanes heights;
        Lanes3 pushed, vectors;
        AreaHeights(light, receivers.position, heights, pushed);
        FormFactorVectors(pushed, light.polygon, vectors);
        return SetDirectionsToArea(vectors, receivers.normal, incident.undirected, incident.directions);
    }
    if (light.type == LightType::Area)
        factor.fill(1 / kLeastCosine);
    else if (light.type == LightType::Sun)
        for (const std::size_t i : kEachLane)
            factor[i] = 1 / std::max(angleFactor[i], kLeastCosine);
    else
        SetTowardLight(light, angleFactor, incident.distance, factor);
    SetDirectionsToPoint(factor, cosine, incident);
}

} // namespace q3
