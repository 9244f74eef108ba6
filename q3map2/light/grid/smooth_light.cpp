// GPL-2.0-or-later. Light at any position in the open, with weak light interpolated where it is smooth.
#include "q3map2/light/grid/smooth_light.h"

namespace q3 {

std::vector<ProbeLight> SmoothLight::At(std::span<const ProbeReceiver> receivers, std::uint64_t seed,
                                        GridStats &work) const {
    std::vector<std::optional<WeakLight>> weak(receivers.size());
    for (std::size_t i = 0; i < receivers.size() && weak_; ++i)
        weak[i] = weak_->Between(receivers[i].position);
    return At(receivers, weak, seed, work);
}

std::vector<ProbeLight> SmoothLight::At(std::span<const ProbeReceiver> receivers,
                                        std::span<const std::optional<WeakLight>> weak, std::uint64_t seed,
                                        GridStats &work) const {
    std::vector<ProbeLight> lit(receivers.size());
    std::vector<ReceiverBatch> known, unknown;
    std::vector<std::size_t> knownAt, unknownAt; // numbers of the receivers
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        (weak[i] ? knownAt : unknownAt).push_back(i);
        const ProbeReceiver &one = receivers[i];
        BatchWithRoom(weak[i] ? known : unknown).Add(one.position, one.position, one.cluster, one.seed);
    }
    std::size_t next = 0;
    if (!unknown.empty())
        integrator_.Trace(unknown, seed, work,
                          [&](std::uint32_t, const bspGridPointSH_t &value, const WeakLight &weakPart) {
                              lit[unknownAt[next++]] = {value, weakPart};
                          });
    if (!known.empty())
        integrator_.TraceStrong(
            known, seed, work, [&](std::size_t i) { return *weak[knownAt[i]]; },
            [&](std::size_t i, const bspGridPointSH_t &value) {
                lit[knownAt[i]] = {value, *weak[knownAt[i]]};
            });
    return lit;
}

} // namespace q3
