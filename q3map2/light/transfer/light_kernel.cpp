// GPL-2.0-or-later. Steps from a light to receivers that grids, luxels and vertices share, and counts of that work.
#include "q3map2/light/transfer/light_kernel.h"

#include "q3map2/light/sources/falloff.h"
#include "q3map2/light/transfer/light_contribution.h"

#include <algorithm>

namespace q3 {

namespace {

/// Receivers that get at most `least` are live no longer.
void CullBelow(float least, IncidentLight &incident) {
    Vectorize([&, least]() Q3_INLINE {
        for (const std::size_t i : kEachLane) {
            const float strength = incident.strength[i];
            incident.live[i] = strength > least ? incident.live[i] : 0;
        }
    });
}

void SetFalloff(Falloff falloff, const Lanes &angleFactor, IncidentLight &incident) {
    Vectorize([&, falloff]() Q3_INLINE {
        const Lanes &distance = incident.distance;
        Lanes &strength = incident.strength;
        switch (falloff.Curve()) {
        case FalloffCurve::InverseSquare:
            for (const std::size_t i : kEachLane)
                strength[i] = falloff.InverseSquare(distance[i], angleFactor[i]);
            break;
        case FalloffCurve::Linear:
            for (const std::size_t i : kEachLane)
                strength[i] = falloff.Linear(distance[i], angleFactor[i]);
            break;
        case FalloffCurve::Windowed:
            for (const std::size_t i : kEachLane)
                strength[i] = falloff.Windowed(distance[i], angleFactor[i]);
            break;
        case FalloffCurve::Polynomial:
            for (const std::size_t i : kEachLane)
                strength[i] = falloff.Polynomial(distance[i], angleFactor[i]);
            break;
        }
    });
}

} // namespace

LaneMask InSight(const Light &light, bool skipPvs, const ReceiverBatch &receivers, ContributionCounts &counts) {
    return Vectorize([&, skipPvs]() Q3_INLINE {
        LaneMask live = receivers.wanted;
        const int wanted = live.Count();
        counts.pairs += std::uint64_t(wanted);
        if (!skipPvs || light.seenFrom.empty())
            return live;
        unsigned seen = 0;
        for (std::size_t i = 0; i < receivers.clusters.count; ++i)
            seen |= light.SeenFrom(receivers.clusters.number[i]) ? receivers.clusters.lanes[i] : 0;
        live.Keep(seen);
        counts.skippedPvs += std::uint64_t(wanted - live.Count());
        return live;
    });
}

void AimAt(const Vec3f &target, const Lanes3 &position, IncidentLight &incident) {
    Vectorize([&]() Q3_INLINE {
        const Vec3f t = target;
        for (const std::size_t i : kEachLane) {
            const auto [x, y, z, d] = DirectionOf(t.x - position.x[i], t.y - position.y[i], t.z - position.z[i]);
            incident.distance[i] = d;
            incident.direction.x[i] = x, incident.direction.y[i] = y, incident.direction.z[i] = z;
        }
    });
}

void AimAtSun(const Light &light, IncidentLight &incident) {
    incident.direction.Fill(-light.normal);
    incident.distance.fill(kSunDistance);
}

void SetPointLight(const Light &light, const Lanes &angleFactor, IncidentLight &incident) {
    SetFalloff(Falloff(light), angleFactor, incident);
    if (light.type != LightType::Spot)
        return;
    for (const std::size_t i : kEachLane)
        if (incident.live[i] != 0 && incident.strength[i] > 0)
            incident.strength[i] *= ConeFraction(light, incident.direction[i] * incident.distance[i]);
}

void AreaHeights(const Light &light, const Lanes3 &position, Lanes &heights, Lanes3 &pushed) {
    Vectorize([&]() Q3_INLINE {
        const Vec3f n = light.normal;
        const float dist = light.dist;
        for (const std::size_t i : kEachLane) {
            const float x = position.x[i], y = position.y[i], z = position.z[i];
            const float height = x * n.x + y * n.y + z * n.z - dist;
            const float push = std::abs(height) < kAreaPush ? kAreaPush - height : 0;
            heights[i] = height;
            pushed.x[i] = x + n.x * push, pushed.y[i] = y + n.y * push, pushed.z[i] = z + n.z * push;
        }
    });
}

void CullBelowTolerance(const Light &light, IncidentLight &incident) {
    CullBelow(light.endsAtTolerance && light.type != LightType::Sun ? light.tolerance : 0, incident);
}

float Strongest(const IncidentLight &incident) {
    return Vectorize([&]() Q3_INLINE {
        float strongest = 0;
        for (const std::size_t i : kEachLane)
            strongest = std::max(strongest, incident.live[i] != 0 ? incident.strength[i] : 0);
        return strongest;
    });
}

bool ApplyFaintSelection(const Light &light, float faint, float weight, ReceiverBatch &receivers,
                         IncidentLight &incident, ContributionCounts &counts) {
    if (light.type == LightType::Area && faint > 0 &&
        !SelectFaintLight(faint, Strongest(incident), receivers.faintResidual, weight)) {
        counts.skippedFaint += std::uint64_t(incident.live.Count());
        incident.live = {};
        return false;
    }
    if (weight != 1)
        for (float &strength : incident.strength)
            strength *= weight;
    return true;
}

void SetShadowRays(const ReceiverBatch &receivers, const IncidentLight &incident, RayPacket &rays) {
    rays.origin = receivers.rayOrigin;
    rays.direction = incident.direction;
    rays.distance = incident.distance;
    rays.live = incident.live;
}

void ApplyShadowRays(const RayPacket &rays, IncidentLight &incident) {
    incident.live = rays.live;
    incident.tinted = rays.tinted;
    if (rays.tinted)
        incident.tint = rays.tint;
}

} // namespace q3
