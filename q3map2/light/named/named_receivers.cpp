// GPL-2.0-or-later. Receivers of a grid that names lights: all light that arrives there, and the share of each light.
#include "q3map2/light/named/named_receivers.h"

#include <algorithm>

namespace q3 {

const LightHere *NamedReceiver::Find(std::uint32_t number) const {
    const auto found = std::ranges::lower_bound(lights, number, {}, &LightHere::light);
    return found != lights.end() && found->light == number ? &*found : nullptr;
}

std::optional<LightHere> NamedReceiver::At(std::uint32_t number, const LightTable &table) const {
    if (const LightHere *here = Find(number))
        return *here;
    const LightHere hidden{number, 0, table.RoughVector(number, position)};
    if (hidden.Squared() < kFaintest * kFaintest || !table.MaySee(number, cluster))
        return hidden;
    return {};
}

void LightCollector::Add(std::uint32_t light, std::size_t receiver, float unshadowed, float visible) {
    std::vector<Sum> &sums = sums_[receiver];
    // Searched from the back, since the pieces of a lamp mostly follow each other.
    auto at = std::find_if(sums.rbegin(), sums.rend(), [&](const Sum &sum) { return sum.light == light; });
    if (at == sums.rend()) {
        sums.push_back({light, 0, 0});
        at = sums.rbegin();
    }
    at->unshadowed += unshadowed;
    at->arrived += unshadowed * visible;
}

void LightCollector::See(const WeightedLight &light, std::span<const ReceiverBatch> blocks,
                         std::span<const ProbeIncidentLight> incident) {
    if (light.weight != 1) // it represents several faint lights, whose own shares are unknown
        return;
    const std::uint32_t number = table_.NumberOf(*light.light);
    for (std::size_t block = 0; block < blocks.size(); ++block)
        for (std::size_t i = 0; i < blocks[block].count; ++i)
            if (incident[block].unshadowed[i] > 0)
                Add(number, number_ == Number::ByIndex ? blocks[block].index[i] : block * kPacketSize + i,
                    incident[block].unshadowed[i], incident[block].visible[i]);
}

std::vector<LightHere> LightCollector::Of(std::size_t receiver, const Vec3f &position) const {
    std::vector<LightHere> lights;
    for (const Sum &sum : sums_[receiver]) {
        const LightHere here{sum.light, std::clamp(sum.arrived / sum.unshadowed, 0.0f, 1.0f),
                             table_.RoughVector(sum.light, position)};
        if (here.Squared() >= kFaintest * kFaintest)
            lights.push_back(here);
    }
    std::ranges::sort(lights, {}, &LightHere::light);
    return lights;
}

bool LightCollector::IsOnLight(std::size_t receiver, const Vec3f &position) const {
    return std::ranges::any_of(sums_[receiver], [&](const Sum &sum) { return table_.HasInPlane(sum.light, position); });
}

} // namespace q3
