// GPL-2.0-or-later. What one light gives to receivers on surfaces.
#include "libs/math/lane_functions.h"
#include "q3map2/light/batch/form_factor.h"
#include "q3map2/light/transfer/light_terms.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace q3 {

namespace {

/// Receivers less than this in front of an area light, and not turned away from its facing, lie in its own surface.
constexpr float kAreaOwnSide = 3, kAreaOwnCosine = 0.9f;
/// One-sided area lights do not light what is farther behind them. Game units.
constexpr float kAreaBehind = 1;
/// Half-Lambert light starts here. A cosine.
constexpr float kLeastHalfLambert = 0.001f;

/// Receivers toward a light, without shadows.
class SurfaceTransfer {
  public:
    SurfaceTransfer(const Light &light, const SurfaceLightSettings &settings, const SurfaceReceiverBatch &samples,
                    SurfaceIncidentLight &incident)
        : light_(light), settings_(settings), samples_(samples), incident_(incident) {}

    /// Sets add, direction, distance, undirected; ends receivers that get nothing. Number of the others.
    int Evaluate() {
        if (light_.type == LightType::Sun) {
            Sun();
        } else {
            if (!Aim())
                return 0;
            if (light_.type != LightType::Area)
                Point();
            else if (!Area())
                return 0;
        }
        return CullFaint();
    }

  private:
    bool Aim();
    void Angles();
    void Sun();
    void Point();
    bool Area();
    bool AreaSides(Lanes3 &pushed);
    void AreaFormFactors(const Lanes &f);
    void AreaPoints();
    void TurnBack(const LaneMask &flipped);
    int CullFaint();

    const Light &light_;
    const SurfaceLightSettings &settings_;
    const SurfaceReceiverBatch &samples_;
    SurfaceIncidentLight &incident_;
    Lanes cosine_; ///< of the normal to the light
    Lanes angle_;  ///< factor of the angle of incidence
};

/// Direction and distance to the light; ends receivers beyond its reach or behind the surface.
Q3_VECTOR bool SurfaceTransfer::Aim() {
    const Lanes3 &p = samples_.position, &n = samples_.normal;
    const Vec3f target = light_.origin;
    const float envelope = light_.envelope;
    const bool twoSided = samples_.twoSided;
    std::int32_t any = 0;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float x = target.x - p.x[i], y = target.y - p.y[i], z = target.z - p.z[i];
        const float d = std::sqrt(x * x + y * y + z * z), scale = 1 / (d > 0 ? d : 1);
        const float cosine = (x * n.x[i] + y * n.y[i] + z * n.z[i]) * scale;
        incident_.distance[i] = d;
        incident_.direction.x[i] = x * scale;
        incident_.direction.y[i] = y * scale;
        incident_.direction.z[i] = z * scale;
        cosine_[i] = cosine;
        incident_.live[i] = (d < envelope) & (twoSided | (cosine >= 0)) ? incident_.live[i] : 0;
        any |= incident_.live[i];
    }
    return any != 0;
}

/// Factor of the angle of incidence; light from behind on two-sided surfaces has no direction.
Q3_VECTOR void SurfaceTransfer::Angles() {
    const bool twoSided = samples_.twoSided, half = settings_.halfLambert;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const bool behind = twoSided & (cosine_[i] < 0);
        const float cosine = behind ? -cosine_[i] : cosine_[i];
        const float wrapped = 0.5f * std::min(cosine, 1.0f) + 0.5f;
        angle_[i] = !half ? cosine : cosine > kLeastHalfLambert ? wrapped * wrapped : 0;
        incident_.undirected[i] = behind ? -1 : 0;
    }
}

Q3_VECTOR void SurfaceTransfer::Sun() {
    const Lanes3 &n = samples_.normal;
    const Vec3f to = -light_.normal;
    incident_.direction.Fill(to);
    incident_.distance.fill(kSunDistance);
    for (std::size_t i = 0; i < kPacketSize; ++i)
        cosine_[i] = to.x * n.x[i] + to.y * n.y[i] + to.z * n.z[i];
    Angles();
    for (std::size_t i = 0; i < kPacketSize; ++i)
        incident_.add[i] = light_.photons * angle_[i];
}

/// Falloff of point lights and spotlights.
Q3_VECTOR void SurfaceTransfer::Point() {
    if (light_.angle)
        Angles();
    else {
        angle_.fill(1);
        incident_.undirected = {};
    }
    if (light_.angleScale != 0)
        for (float &angle : angle_)
            angle = std::min(1.0f, angle / light_.angleScale);
    const float extra2 = light_.extraDist * light_.extraDist;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float d = std::max(kNearest, std::sqrt(incident_.distance[i] * incident_.distance[i] + extra2));
        incident_.add[i] = light_.linear ? angle_[i] * light_.photons * kLinearScale - d * light_.fade
                                         : light_.photons / (d * d) * angle_[i];
    }
    if (light_.type == LightType::Spot)
        for (std::size_t i = 0; i < kPacketSize; ++i)
            if (incident_.live[i] != 0 && incident_.add[i] > 0)
                incident_.add[i] *= ConeShare(light_, incident_.direction[i] * incident_.distance[i]);
}

/// Ends receivers behind an area light or in its own surface; `pushed` is where its form factor is taken.
Q3_VECTOR bool SurfaceTransfer::AreaSides(Lanes3 &pushed) {
    const Lanes3 &p = samples_.position, &n = samples_.normal;
    const Vec3f facing = light_.normal;
    const bool oneSided = !light_.twoSided;
    std::int32_t any = 0;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float s = p.x[i] * facing.x + p.y[i] * facing.y + p.z[i] * facing.z - light_.dist;
        const float along = n.x[i] * facing.x + n.y[i] * facing.y + n.z[i] * facing.z;
        const bool hidden =
            (s < kAreaOwnSide) & ((oneSided & (s < -kAreaBehind)) | ((s > -kAreaOwnSide) & (along > kAreaOwnCosine)));
        incident_.live[i] = hidden ? 0 : incident_.live[i];
        any |= incident_.live[i];
        const float push = (s > -kAreaPush) & (s < kAreaPush) ? kAreaPush - s : 0;
        pushed.x[i] = p.x[i] + facing.x * push;
        pushed.y[i] = p.y[i] + facing.y * push;
        pushed.z[i] = p.z[i] + facing.z * push;
    }
    return any != 0;
}

/// -faster: two cosines and the distance.
Q3_VECTOR void SurfaceTransfer::AreaPoints() {
    const Lanes3 &u = incident_.direction;
    const Vec3f facing = light_.normal;
    const bool anySide = samples_.twoSided || light_.twoSided;
    const float extra2 = light_.extraDist * light_.extraDist;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const bool behind = samples_.twoSided & (cosine_[i] < 0);
        float angle =
            (behind ? -cosine_[i] : cosine_[i]) * -(u.x[i] * facing.x + u.y[i] * facing.y + u.z[i] * facing.z);
        const bool turned = (angle < 0) & anySide;
        angle = turned ? -angle : angle;
        incident_.undirected[i] = behind | turned ? -1 : 0;
        const float d = std::max(kNearest, std::sqrt(incident_.distance[i] * incident_.distance[i] + extra2));
        incident_.add[i] = light_.photons / (d * d) * angle;
    }
}

/// Light that comes from the back of a two-sided light comes from behind its plane.
Q3_VECTOR void SurfaceTransfer::TurnBack(const LaneMask &flipped) {
    const Lanes3 &p = samples_.position;
    const Vec3f target = light_.origin - light_.normal * 2;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float x = target.x - p.x[i], y = target.y - p.y[i], z = target.z - p.z[i];
        const float d = std::sqrt(x * x + y * y + z * z), scale = 1 / (d > 0 ? d : 1);
        const bool on = flipped[i] != 0;
        incident_.distance[i] = on ? d : incident_.distance[i];
        incident_.direction.x[i] = on ? x * scale : incident_.direction.x[i];
        incident_.direction.y[i] = on ? y * scale : incident_.direction.y[i];
        incident_.direction.z[i] = on ? z * scale : incident_.direction.z[i];
        incident_.live[i] = on & (d >= light_.envelope) ? 0 : incident_.live[i];
    }
}

Q3_VECTOR void SurfaceTransfer::AreaFormFactors(const Lanes &f) {
    const bool anySide = samples_.twoSided || light_.twoSided;
    LaneMask flipped;
    std::int32_t any = 0;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const bool flip = (f[i] < 0) & anySide;
        incident_.add[i] = (flip ? -f[i] : f[i]) * light_.add;
        incident_.undirected[i] = flip | (cosine_[i] < 0) ? -1 : 0;
        flipped[i] = flip ? incident_.live[i] : 0;
        any |= flipped[i];
    }
    if (any != 0)
        TurnBack(flipped);
}

bool SurfaceTransfer::Area() {
    Lanes3 pushed;
    if (!AreaSides(pushed))
        return false;
    if (settings_.pointAreas) {
        AreaPoints();
        return true;
    }
    Lanes f;
    FormFactors(pushed, samples_.normal, light_.w, f);
    AreaFormFactors(f);
    return true;
}

Q3_VECTOR int SurfaceTransfer::CullFaint() {
    const float least = light_.fast && light_.type != LightType::Sun ? light_.tolerance : 0;
    int left = 0;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        incident_.live[i] = incident_.add[i] > least ? incident_.live[i] : 0;
        left -= incident_.live[i];
    }
    return left;
}

Q3_VECTOR float Strongest(const SurfaceIncidentLight &incident) {
    float strongest = 0;
    for (std::size_t i = 0; i < kPacketSize; ++i)
        strongest = std::max(strongest, incident.live[i] != 0 ? incident.add[i] : 0);
    return strongest;
}

Q3_VECTOR void Trace(const Light &light, const SurfaceLightSettings &settings, const LightScene &scene,
                     const SurfaceReceiverBatch &samples, SurfaceIncidentLight &incident, ContributionCounts &counts) {
    RayPacket rays;
    rays.origin = samples.position;
    rays.direction = incident.direction;
    rays.distance = incident.distance;
    rays.live = incident.live;
    if (light.type == LightType::Sun)
        scene.TraceSurfaceToSky(rays, light.skyIndex, settings.receiveShadows, counts);
    else
        scene.TraceSurfaceToLight(rays, settings.receiveShadows, counts);
    incident.live = rays.live;
    incident.filtered = rays.filtered;
    incident.tinted = rays.tinted;
    if (rays.tinted)
        incident.tint = rays.tint;
}

} // namespace

void SurfaceReceiverBatch::Add(const Vec3f &at, const Vec3f &normalAt, int clusterAt) {
    position.Set(count, at);
    normal.Set(count, normalAt);
    clusters.Add(count, clusterAt);
    wanted[count] = -1;
    ++count;
}

Q3_VECTOR void FormFactors(const Lanes3 &p, const Lanes3 &n, std::span<const Vec3f> w, Lanes &f) {
    Lanes total{};
    LaneMask wrong{};
    Lanes3 a;
    for (std::size_t i = 0; i < kPacketSize && !w.empty(); ++i)
        a.x[i] = w.back().x - p.x[i], a.y[i] = w.back().y - p.y[i], a.z[i] = w.back().z - p.z[i];
    Vec3f last = w.empty() ? Vec3f{} : w.back();
    for (const Vec3f &corner : w) {
        const Vec3f edge = corner - last;
        last = corner;
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            const float ax = a.x[i], ay = a.y[i], az = a.z[i];
            const float bx = corner.x - p.x[i], by = corner.y - p.y[i], bz = corner.z - p.z[i];
            // The edge keeps the digits that the difference of two far corners has lost.
            const float cx = ay * edge.z - az * edge.y, cy = az * edge.x - ax * edge.z, cz = ax * edge.y - ay * edge.x;
            const float sine = std::sqrt(cx * cx + cy * cy + cz * cz), cosine = ax * bx + ay * by + az * bz;
            const float along = n.x[i] * cx + n.y[i] * cy + n.z[i] * cz;
            total[i] += sine > 0 ? AngleOf(sine, cosine) * along / sine : 0;
            wrong[i] |= std::abs(total[i]) > kMostFormAngle ? -1 : 0;
            a.x[i] = bx, a.y[i] = by, a.z[i] = bz;
        }
    }
    constexpr float kScale = 0.5f / std::numbers::pi_v<float>;
    for (std::size_t i = 0; i < kPacketSize; ++i)
        f[i] = wrong[i] != 0 ? 0 : total[i] * kScale;
}

void LightContributionToSample(const Light &light, const SurfaceLightSettings &settings, const LightScene &scene,
                               SurfaceReceiverBatch &samples, SurfaceIncidentLight &incident,
                               ContributionCounts &counts) {
    incident.tinted = false;
    incident.filtered = {};
    incident.live = {};
    const bool sun = light.type == LightType::Sun;
    if (!light.surfaces || (settings.sunOnly && !sun))
        return;
    const bool traced = settings.Occludes(light);
    incident.live = InSight(light, traced || !sun, samples, counts);
    const int inSight = incident.live.Count();
    if (inSight == 0)
        return;
    const int inReach = SurfaceTransfer(light, settings, samples, incident).Evaluate();
    counts.skippedFacing += std::uint64_t(inSight - inReach);
    if (inReach == 0) {
        incident.live = {};
        return;
    }
    if (light.type == LightType::Area && settings.faint > 0) {
        float weight = 1;
        if (!SelectFaintLight(settings.faint, Strongest(incident), samples.faintResidual, weight)) {
            counts.skippedFaint += std::uint64_t(inReach);
            incident.live = {};
            return;
        }
        if (weight != 1)
            for (float &add : incident.add)
                add *= weight;
    }
    if (traced)
        Trace(light, settings, scene, samples, incident, counts);
}

} // namespace q3
