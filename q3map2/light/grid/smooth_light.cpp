// GPL-2.0-or-later. Light at any position in the open.
#include "q3map2/light/grid/smooth_light.h"

namespace q3 {

namespace {

void AddProbe(const ProbeReceiver &one, std::vector<ReceiverBatch> &blocks) {
    BatchWithRoom(blocks).Add(one.position, one.position, one.cluster, one.seed);
}

} // namespace

std::vector<bspGridPointSH_t> SmoothLight::At(std::span<const ProbeReceiver> receivers, std::uint64_t seed,
                                              GridStats &work) const {
    if (weak_) {
        std::vector<std::optional<WeakLight>> weak;
        for (const ProbeReceiver &one : receivers) {
            weak.push_back(weak_->Interpolate(one.position, {}));
            work.skippedSmooth += weak.back() ? 1 : 0;
        }
        AddWeak(receivers, seed, weak, work);
        return AddStrong(receivers, seed, weak, work);
    }
    std::vector<ReceiverBatch> blocks;
    for (const ProbeReceiver &one : receivers)
        AddProbe(one, blocks);
    std::vector<bspGridPointSH_t> values(receivers.size());
    if (!blocks.empty())
        integrator_.Trace(blocks, seed, work, [&](std::size_t i, const bspGridPointSH_t &value) { values[i] = value; });
    return values;
}

void SmoothLight::AddWeak(std::span<const ProbeReceiver> receivers, std::uint64_t seed,
                          std::span<std::optional<WeakLight>> weak, GridStats &work) const {
    std::vector<ReceiverBatch> blocks;
    std::vector<std::size_t> numbers;
    for (std::size_t i = 0; i < receivers.size(); ++i)
        if (!weak[i])
            numbers.push_back(i), AddProbe(receivers[i], blocks);
    if (!blocks.empty())
        integrator_.TraceWeak(blocks, seed, work,
                              [&](std::size_t i, const WeakLight &light) { weak[numbers[i]] = light; });
}

std::vector<bspGridPointSH_t> SmoothLight::AddStrong(std::span<const ProbeReceiver> receivers, std::uint64_t seed,
                                                     std::span<const std::optional<WeakLight>> weak,
                                                     GridStats &work) const {
    std::vector<ReceiverBatch> blocks;
    for (const ProbeReceiver &one : receivers)
        AddProbe(one, blocks);
    std::vector<bspGridPointSH_t> values(receivers.size());
    if (!blocks.empty())
        integrator_.TraceStrong(
            blocks, seed, work, [&](std::size_t i) -> const WeakLight & { return *weak[i]; },
            [&](std::size_t i, const bspGridPointSH_t &value) { values[i] = value; });
    return values;
}

} // namespace q3
