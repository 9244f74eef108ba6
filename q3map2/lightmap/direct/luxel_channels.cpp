// GPL-2.0-or-later. Directional channels of the light of one source on a block of luxels.
#include "q3map2/lightmap/direct/luxel_channels.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// out = light of the source times `weight`.
Q3_VECTOR void SetColor(const Vec3f &color, const SurfaceIncidentLight &incident, const Lanes &weight, Lanes3 &out) {
    const Vec3f c = color;
    for (const std::size_t i : kEachLane) {
        const float light = incident.live[i] != 0 ? incident.add[i] * weight[i] : 0;
        out.x[i] = light * c.x, out.y[i] = light * c.y, out.z[i] = light * c.z;
    }
    if (!incident.tinted)
        return;
    for (const std::size_t i : kEachLane)
        if (incident.live[i] != 0)
            out.x[i] *= incident.tint.x[i], out.y[i] *= incident.tint.y[i], out.z[i] *= incident.tint.z[i];
}

/// Weights of the SH channels.
Q3_VECTOR void ProjectOnSh(const LightDirections &from, std::array<Lanes, DirectionalChannels::kSh> &weights) {
    for (const std::size_t i : kEachLane) {
        const float x = from.vector.x[i], y = from.vector.y[i], z = from.vector.z[i];
        const float fluence = std::sqrt(x * x + y * y + z * z) * from.spread[i];
        weights[0][i] = kDirectedSh0 * fluence + kUniformSh0 * from.uniform[i];
        weights[1][i] = kDirectedSh1 * y, weights[2][i] = kDirectedSh1 * z, weights[3][i] = kDirectedSh1 * x;
    }
}

/// Light on receivers with the given normals.
Q3_VECTOR void LightOn(const Lanes3 &normal, const LightDirections &from, Lanes &weights) {
    for (const std::size_t i : kEachLane) {
        const float facing =
            from.vector.x[i] * normal.x[i] + from.vector.y[i] * normal.y[i] + from.vector.z[i] * normal.z[i];
        weights[i] = std::max(0.0f, facing) + from.uniform[i];
    }
}

} // namespace

void SetChannels(const Vec3f &color, const SurfaceIncidentLight &incident, const DirectionalChannels &channels,
                 const BasisLanes *basis, ChannelLanes &out) {
    if (channels.sh) {
        std::array<Lanes, DirectionalChannels::kSh> weights;
        ProjectOnSh(incident.directions, weights);
        for (std::size_t c = 0; c < weights.size(); ++c)
            SetColor(color, incident, weights[c], out[c]);
    }
    for (std::size_t i = 0; basis && i < basis->size(); ++i) {
        Lanes weights;
        LightOn((*basis)[i], incident.directions, weights);
        SetColor(color, incident, weights, out[channels.FirstBasis() + i]);
    }
}

} // namespace q3
