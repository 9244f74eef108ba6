// GPL-2.0-or-later. Which share of each named light arrives at receivers.
#include "q3map2/light/named/visible_shares.h"

#include <algorithm>

namespace q3 {

void ShareSums::Add(const WeightedLight &light, std::size_t receiver, float unshadowed, float visible) {
    if (!(unshadowed > 0) || light.weight != 1) // one that represents others says nothing of itself
        return;
    const std::uint32_t number = table_.NumberOf(*light.light);
    std::vector<Sum> &sums = sums_[receiver];
    // Lights of one lamp mostly follow each other.
    auto at = std::find_if(sums.rbegin(), sums.rend(), [&](const Sum &sum) { return sum.light == number; });
    if (at == sums.rend()) {
        sums.push_back({number, 0, 0});
        at = sums.rbegin();
    }
    at->unshadowed += unshadowed;
    at->arrived += unshadowed * visible;
}

std::vector<LightShare> ShareSums::Of(std::size_t receiver) const {
    std::vector<LightShare> shares;
    for (const Sum &sum : sums_[receiver])
        shares.push_back({sum.light, std::clamp(sum.arrived / sum.unshadowed, 0.0f, 1.0f)});
    return shares;
}

void BrickShares::See(const WeightedLight &light, std::span<const ReceiverBatch> blocks,
                      std::span<const ProbeIncidentLight> incident) {
    for (std::size_t block = 0; block < blocks.size(); ++block)
        for (std::size_t i = 0; i < blocks[block].count; ++i)
            sums_.Add(light, block * kPacketSize + i, incident[block].unshadowed[i], incident[block].visible[i]);
}

void GridShares::See(const WeightedLight &light, std::span<const ReceiverBatch> blocks,
                     std::span<const ProbeIncidentLight> incident) {
    for (std::size_t block = 0; block < blocks.size(); ++block)
        for (std::size_t i = 0; i < blocks[block].count; ++i)
            sums_.Add(light, blocks[block].index[i], incident[block].unshadowed[i], incident[block].visible[i]);
}

} // namespace q3
