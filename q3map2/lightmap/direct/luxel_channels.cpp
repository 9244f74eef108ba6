// GPL-2.0-or-later. Directional channels of the light of one source on a block of luxels.
#include "q3map2/lightmap/direct/luxel_channels.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// amounts = SH channels for a light of color 1 1 1, before the tint.
Q3_VECTOR void ProjectOnSh(const SurfaceIncidentLight &incident, std::array<Lanes, DirectionalChannels::kSh> &amounts) {
    const LightDirections &from = incident.directions;
    for (const std::size_t i : kEachLane) {
        const float add = incident.add[i];
        const float x = from.vector.x[i], y = from.vector.y[i], z = from.vector.z[i];
        const float fluence = std::sqrt(x * x + y * y + z * z) * from.spread[i];
        amounts[0][i] = add * (kDirectedSh0 * fluence + kUniformSh0 * from.uniform[i]);
        amounts[1][i] = add * (kDirectedSh1 * y);
        amounts[2][i] = add * (kDirectedSh1 * z);
        amounts[3][i] = add * (kDirectedSh1 * x);
    }
}

/// Irradiance from a sphere that crosses the horizon, divided by its irradiance on a receiver that faces it. sine2:
/// squared sine of its angular radius; cosine: of the angle from the normal to its center, |cosine| < sqrt(sine2).
/// Snyder, Area Light Sources for Real-Time Graphics, 1996.
float SphereAtHorizon(float cosine, float sine2) {
    const float sine = std::sqrt(std::max(1e-12f, 1 - cosine * cosine)), x = std::sqrt(1 / sine2 - 1);
    const float y = std::clamp(-x * cosine / sine, -1.0f, 1.0f), root = sine * std::sqrt(1 - y * y);
    const float sum = (cosine * std::acos(y) - x * root) * sine2 + std::atan2(root, x);
    return std::max(0.0f, sum / (sine2 * std::numbers::pi_v<float>));
}

/// amount = light on receivers with the given normals for a light of color 1 1 1, before the tint; live lanes only. An
/// area light that crosses the horizon of a receiver counts as a sphere.
void LightOn(const Lanes3 &normal, const SurfaceIncidentLight &incident, Lanes &amount) {
    constexpr float kPointlike = 1e-4f;
    const LightDirections &from = incident.directions;
    for (const std::size_t i : kEachLane) {
        if (incident.live[i] == 0)
            continue;
        const float facing = Dot(from.vector[i], normal[i]);
        const float cosineOfRadius = 2 / from.spread[i] - 1, sine2 = 1 - cosineOfRadius * cosineOfRadius;
        const float length2 = Dot(from.vector[i], from.vector[i]);
        float light = std::max(0.0f, facing);
        if (sine2 > kPointlike && facing * facing < sine2 * length2) {
            const float length = std::sqrt(length2);
            light = length * SphereAtHorizon(facing / length, sine2);
        }
        amount[i] = incident.add[i] * (light + from.uniform[i]);
    }
}

} // namespace

Q3_VECTOR void SetIncidentColor(const Vec3f &color, const SurfaceIncidentLight &incident, const Lanes &amount,
                                Lanes3 &out) {
    const Vec3f c = color;
    for (const std::size_t i : kEachLane) {
        const float light = incident.live[i] != 0 ? amount[i] : 0;
        out.x[i] = light * c.x, out.y[i] = light * c.y, out.z[i] = light * c.z;
    }
    if (!incident.tinted)
        return;
    for (const std::size_t i : kEachLane)
        if (incident.live[i] != 0)
            out.x[i] *= incident.tint.x[i], out.y[i] *= incident.tint.y[i], out.z[i] *= incident.tint.z[i];
}

void SetChannels(const Vec3f &color, const SurfaceIncidentLight &incident, const DirectionalChannels &channels,
                 const BasisLanes *basis, ChannelLanes &out) {
    if (channels.sh) {
        std::array<Lanes, DirectionalChannels::kSh> amounts;
        ProjectOnSh(incident, amounts);
        for (std::size_t c = 0; c < amounts.size(); ++c)
            SetIncidentColor(color, incident, amounts[c], out[c]);
    }
    for (std::size_t i = 0; basis && i < basis->size(); ++i) {
        Lanes amount;
        LightOn((*basis)[i], incident, amount);
        SetIncidentColor(color, incident, amount, out[channels.FirstBasis() + i]);
    }
}

} // namespace q3
