// GPL-2.0-or-later. The light of one source on a block of luxels, and sums of such light.
#include "q3map2/lightmap/direct/luxel_contribution.h"

#include "q3map2/lightmap/raw/deluxe.h"

#include <algorithm>

namespace q3 {

namespace {

/// Color and direction of incident light. directionScale: length of a direction per unit of light; 0: no
/// directions.
Q3_VECTOR void SetIncidentLight(const Light &light, const SurfaceIncidentLight &from, float directionScale,
                                LuxelIncidentLight &out) {
    SetIncidentColor(light.color, from, from.add, out.color);
    const std::int32_t colored = light.color.x + light.color.y + light.color.z > 0 ? -1 : 0;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        out.lit[i] = from.live[i] & colored;
        out.filtered[i] = from.add[i] > 1 ? from.filtered[i] : 0;
    }
    if (directionScale > 0)
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            const float weight = from.live[i] != 0 && from.undirected[i] == 0 ? from.add[i] * directionScale : 0;
            out.direction.x[i] = weight > 0 ? from.direction.x[i] * weight : 0;
            out.direction.y[i] = weight > 0 ? from.direction.y[i] * weight : 0;
            out.direction.z[i] = weight > 0 ? from.direction.z[i] * weight : 0;
        }
}

} // namespace

LuxelSum &LuxelSums::FindOrAdd(std::size_t slot, float filterRadius, std::size_t blocks) {
    for (std::size_t i = 0; i < used; ++i)
        if (sums[i].slot == slot && sums[i].filterRadius == filterRadius)
            return sums[i];
    if (used == sums.size())
        sums.emplace_back();
    LuxelSum &sum = sums[used++];
    sum.slot = slot, sum.filterRadius = filterRadius;
    sum.color.assign(blocks, {});
    sum.direction.assign(deluxe ? blocks : 0, {});
    sum.channels.assign(directional ? blocks : 0, {});
    return sum;
}

bool LuxelContribution(const Light &light, const LuxelPass &pass, const LightScene &scene,
                       const LuxelReceivers &receivers, LuxelIncidentLight &out, ChannelLanes &channels,
                       ContributionCounts &counts) {
    SurfaceIncidentLight incident;
    LightContributionToSample(light, pass.settings, scene, receivers.batch, incident, counts);
    if (!incident.live.Any() && !incident.filtered.Any())
        return false;
    const float scale = pass.deluxe ? DeluxeWeight(light.color) * (pass.bounce ? kDeluxeBounceShare : 1) : 0;
    SetIncidentLight(light, incident, scale, out);
    if (pass.channels.Any())
        SetChannels(light.color, incident, pass.channels, receivers.basis, channels);
    return true;
}

} // namespace q3
