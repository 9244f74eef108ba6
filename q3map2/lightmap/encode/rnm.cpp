// GPL-2.0-or-later. Directional light as stored: L1 spherical harmonics, and radiosity normal mapping.
#include "q3map2/lightmap/encode/rnm.h"

#include <algorithm>

namespace q3 {

namespace {

/// Not below zero; NaN gives 0.
float LightOrZero(float value) {
    return value > 0 ? value : 0;
}

using ChannelOfMaps = std::array<float, 3>; ///< one color channel of the three maps

ChannelOfMaps RescaledChannel(ChannelOfMaps maps, float flat) {
    flat = LightOrZero(flat);
    double sum = 0;
    for (float &value : maps) {
        value = LightOrZero(value);
        sum += value;
    }
    if (!(sum > 0))
        return {flat, flat, flat};
    for (float &value : maps)
        value = float(value / sum * 3 * flat);
    return maps;
}

/// The largest value gives its excess over 1 to both others, then the middle one to the smallest. Values still above 1,
/// which need a mean above 1, are clamped.
ChannelOfMaps OverflowedChannel(const ChannelOfMaps &maps) {
    std::array<std::size_t, 3> order{0, 1, 2};
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return maps[a] > maps[b]; });
    ChannelOfMaps out = maps;
    float &first = out[order[0]], &second = out[order[1]], &third = out[order[2]];
    const float fromFirst = std::max(0.0f, first - 1) / 2;
    second += fromFirst, third += fromFirst;
    third += std::max(0.0f, second - 1);
    for (float &value : out)
        value = std::min(value, 1.0f);
    return out;
}

template <typename Change> RnmLight ByChannel(const RnmLight &light, Change change) {
    RnmLight out;
    for (std::size_t channel = 0; channel < 3; channel++) {
        const ChannelOfMaps values =
            change({light.map[0][channel], light.map[1][channel], light.map[2][channel]}, channel);
        for (std::size_t i = 0; i < 3; i++)
            out.map[i][channel] = values[i];
    }
    return out;
}

} // namespace

RnmLight RescaleToFlat(const RnmLight &raw, const Vec3f &flat) {
    return ByChannel(
        raw, [&](const ChannelOfMaps &maps, std::size_t channel) { return RescaledChannel(maps, flat[channel]); });
}

RnmLight OverflowToOthers(const RnmLight &light) {
    return ByChannel(light, [](const ChannelOfMaps &maps, std::size_t) { return OverflowedChannel(maps); });
}

} // namespace q3
