// GPL-2.0-or-later. Directional channels of the light of one source on a block of luxels.
#pragma once

#include "q3map2/light/transfer/light_sample.h"
#include "q3map2/lightmap/raw/directional_channels.h"

namespace q3 {

/// The channels of sixteen receivers.
using ChannelLanes = std::array<Lanes3, kMaxChannels>;
/// The RNM basis normals of sixteen receivers.
using BasisLanes = std::array<Lanes3, DirectionalChannels::kBasis>;
inline void SetLane(std::size_t lane, const BasisNormals &normals, BasisLanes &basis) {
    for (std::size_t i = 0; i < normals.size(); ++i)
        basis[i].Set(lane, normals[i]);
}

/// Sets `out` to light of a source: `amount` at each receiver times `color` and the tint of `incident`; zero in lanes
/// that are not live.
void SetIncidentColor(const Vec3f &color, const SurfaceIncidentLight &incident, const Lanes &amount, Lanes3 &out);

/// Sets the channels of `incident`, light of a source with that color; zero in lanes that are not live. basis: null
/// without basis channels.
void SetChannels(const Vec3f &color, const SurfaceIncidentLight &incident, const DirectionalChannels &channels,
                 const BasisLanes *basis, ChannelLanes &out);

} // namespace q3
