// GPL-2.0-or-later. Error of baked bounced light against the reference.
#include "tools/measure/bounce_error/bounce_errors.h"

#include "tools/measure/shbench/bakes.h"

#include <algorithm>
#include <cmath>

namespace q3::bounce {

namespace {

double Shown(double light) {
    return std::clamp(light, 0.0, 255.0);
}

/// values: ascending.
double Percentile(const std::vector<double> &values, double share) {
    return values.empty() ? 0 : values[std::min(values.size() - 1, std::size_t(share * double(values.size())))];
}

} // namespace

double ShownDifference(const ComparedLight &light, std::size_t channel) {
    const double direct = double(light.direct[channel]);
    return Shown(direct + double(light.bounced[channel])) - Shown(direct + double(light.traced[channel]));
}

double SquaredError(const ComparedLight &light) {
    double sum = 0;
    for (std::size_t channel = 0; channel < 3; ++channel)
        sum += ShownDifference(light, channel) * ShownDifference(light, channel);
    return sum;
}

BounceErrors ErrorsOf(std::span<const ComparedLight> light) {
    BounceErrors errors;
    errors.receivers = light.size();
    std::vector<double> sizes;
    double squares = 0, sum = 0, noise = 0, baked = 0, traced = 0;
    for (const ComparedLight &one : light)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const double difference = ShownDifference(one, channel);
            const double reference = double(one.direct[channel]) + double(one.traced[channel]);
            sizes.push_back(std::abs(difference));
            squares += difference * difference, sum += difference;
            noise += reference < 255 ? double(one.tracedError[channel]) * double(one.tracedError[channel]) : 0;
            baked += double(one.bounced[channel]), traced += double(one.traced[channel]);
        }
    const double count = std::max(1.0, double(sizes.size()));
    std::sort(sizes.begin(), sizes.end());
    errors.rmse = std::sqrt(squares / count);
    errors.percentile95 = Percentile(sizes, 0.95), errors.percentile99 = Percentile(sizes, 0.99);
    errors.bias = sum / count, errors.noise = std::sqrt(noise / count);
    errors.energy = traced != 0 ? baked / traced : 0;
    errors.meanLight = traced / count;
    return errors;
}

std::vector<ComparedLight> CompareLuxels(const Receivers &receivers, const Reference &reference, std::size_t limit,
                                         const BakedLuxels &direct, const BakedLuxels &baked) {
    std::vector<ComparedLight> light;
    for (std::size_t i = 0; i < receivers.luxels.size(); ++i) {
        const LuxelReceiver &at = receivers.luxels[i];
        const Estimate &estimate = reference.luxels[i];
        const Vec3f first = Max(direct.light[at.lightmap][at.luxel], Vec3f{});
        const Vec3f all = Max(baked.light[at.lightmap][at.luxel], Vec3f{});
        light.push_back({first, all - first, estimate.light[limit], estimate.error[limit]});
    }
    return light;
}

std::vector<ComparedLight> ComparePositions(const Receivers &receivers, const Reference &reference, std::size_t limit,
                                            const Bsp &direct, const Bsp &baked) {
    const bench::ShownLight before = bench::ShownBy(bench::BakedFormat::GridSH, direct),
                            after = bench::ShownBy(bench::BakedFormat::GridSH, baked);
    std::vector<ComparedLight> light;
    for (std::size_t i = 0; i < receivers.positions.size(); ++i) {
        const bench::NormalLight first = before(receivers.positions[i]), all = after(receivers.positions[i]);
        for (std::size_t n = 0; n < first.size(); ++n) {
            const Estimate &estimate = reference.positions[i][n];
            light.push_back({first[n] * 255, (all[n] - first[n]) * 255, estimate.light[limit], estimate.error[limit]});
        }
    }
    return light;
}

} // namespace q3::bounce
