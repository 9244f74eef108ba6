// GPL-2.0-or-later. SH coefficients at points in the open.
#include "q3map2/light/grid/probe_integrator.h"

#include "libs/sh/sh.h"
#include "q3map2/light/grid/light_floodlight.h"

#include <algorithm>
#include <numbers>

namespace q3 {

namespace {

/// Limit of coefficients, reached only with absurd keys and scales. 1 = byte 255.
constexpr double kMaxCoefficient = 1e9;

/// Sums of one channel at the receivers of a block, by coefficient; 1 = byte 255.
using ChannelSum = std::array<DoubleLanes, 9>;
/// Stored coefficients of one channel at the receivers of a block.
using StoredChannel = std::array<Lanes, 9>;

/// sum += scale * coefficients, for the three channels at once: the coefficients are read once.
Q3_VECTOR void AddScaled(const ProbeIncidentLight &incident, const Vec3d &scale, std::array<ChannelSum, 3> &sum) {
    const auto [red, green, blue] = scale;
    for (std::size_t k = 0; k < 9; ++k)
        Q3_INDEPENDENT
    for (const std::size_t i : kEachLane) {
        const double coefficient = double(incident.shCoeffs[k][i]);
        sum[0][k][i] += red * coefficient;
        sum[1][k][i] += green * coefficient;
        sum[2][k][i] += blue * coefficient;
    }
}

void AddTinted(const ProbeIncidentLight &incident, const Lanes &tint, double scale, ChannelSum &sum) {
    for (const std::size_t i : kEachLane)
        for (std::size_t k = 0; k < 9 && incident.live[i] != 0; ++k)
            sum[k][i] += scale * double(tint[i]) * double(incident.shCoeffs[k][i]);
}

/// Light at the receivers of a block.
class BlockSum {
  public:
    /// scale: color of the light, 1 = byte 255.
    void Add(const Vec3d &scale, const ProbeIncidentLight &incident) {
        if (!incident.tinted)
            return AddScaled(incident, scale, sum_);
        const Lanes *tints[] = {&incident.tint.x, &incident.tint.y, &incident.tint.z};
        for (std::size_t channel = 0; channel < 3; ++channel)
            AddTinted(incident, *tints[channel], scale[channel], sum_[channel]);
    }
    /// Adds to one coefficient of receiver i.
    void Add(std::size_t i, std::size_t channel, std::size_t k, double light) { sum_[channel][k][i] += light; }
    const std::array<ChannelSum, 3> &Channels() const { return sum_; }

  private:
    std::array<ChannelSum, 3> sum_{};
};

/// Adds floodlight: uniform light from the hemispheres around +z and -z.
void AddFlood(const GridInputs &in, const ReceiverBatch &receivers, std::size_t i, BlockSum &sum, RayCounts &counts) {
    const Vec3f position = receivers.position[i];
    for (const float up : {1.0f, -1.0f}) {
        const float share = FloodShare(in.scene, position, up, in.world.floodDistance, in.floodDirections, counts);
        const Vec3d light = Vec3d(in.world.floodColor) * (double(in.world.floodIntensity) * share / 255);
        const double convolve0 = in.options.shRadiance ? 1 / std::numbers::pi : kCosineLobe[0] / std::numbers::pi;
        const double convolve1 = in.options.shRadiance ? 1 / std::numbers::pi : kCosineLobe[2] / std::numbers::pi;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            sum.Add(i, channel, 0, light[channel] * convolve0 * kShC0 * 2 * std::numbers::pi);
            sum.Add(i, channel, 2, light[channel] * convolve1 * kShC1 * std::numbers::pi * up);
        }
    }
}

/// Adds bounced light.
void AddIndirect(const GridInputs &in, const ReceiverBatch &receivers, std::size_t i, BlockSum &sum,
                 RayCounts &counts) {
    std::vector<IndirectRay> rays;
    in.indirect->Gather(receivers.rayOrigin[i], receivers.index[i], rays);
    counts.rays += rays.size();
    for (const IndirectRay &ray : rays) {
        const ShVector basis = ShBasis(Vec3d(ray.direction));
        for (std::size_t k = 0; k < 9; ++k) {
            const double weight = basis[k] * (in.options.shRadiance ? 1 : kCosineLobe[k]) / 255;
            for (std::size_t channel = 0; channel < 3; ++channel)
                sum.Add(i, channel, k, weight * double(ray.light[channel]));
        }
    }
}

/// Ambient and minimum light of a channel in units of coefficient 0, and the factor for all coefficients.
struct ChannelScale {
    double ambient, least, scale;
};

/// Coefficients of a channel to store; where its mean is negative, zero plus minimum light.
Q3_VECTOR void StoreChannel(const ChannelSum &sum, const ChannelScale &channel, StoredChannel &stored) {
    const auto [ambient, least, scale] = channel;
    for (const std::size_t i : kEachLane) {
        const double mean = sum[0][i] + ambient;
        stored[0][i] = float(std::min(std::max(mean < 0 ? 0 : mean, least) * scale, kMaxCoefficient));
    }
    for (std::size_t k = 1; k < 9; ++k)
        for (const std::size_t i : kEachLane) {
            const double value = sum[0][i] + ambient < 0 ? 0 : sum[k][i] * scale;
            stored[k][i] = float(std::min(std::max(value, -kMaxCoefficient), kMaxCoefficient));
        }
}

/// Appends the values of a block, with ambient light, minimum light and grid scale applied.
void StoreBlock(const GridInputs &in, const BlockSum &sum, std::size_t count, std::vector<bspGridPointSH_t> &values) {
    // Coefficient 0 of uniform ambient light 1.
    const double uniform = 1 / kShC0 / (in.options.shRadiance ? std::numbers::pi : 1);
    std::array<StoredChannel, 3> stored;
    for (std::size_t channel = 0; channel < 3; ++channel)
        StoreChannel(sum.Channels()[channel],
                     {double(in.world.ambient[channel]) / 255 * uniform,
                      double(in.world.minGrid[channel]) / 255 * uniform,
                      in.options.gridScale > 0 ? in.options.gridScale : 1},
                     stored[channel]);
    for (std::size_t i = 0; i < count; ++i) {
        bspGridPointSH_t &point = values.emplace_back();
        for (std::size_t k = 0; k < 9; ++k)
            point.coeffs[k] = {stored[0][k][i], stored[1][k][i], stored[2][k][i]};
    }
}

} // namespace

ProbeIntegrator::ProbeIntegrator(const GridInputs &in, const std::vector<Light> &lights)
    : in_(in), lighting_(in, lights, in.options.shRadiance) {}

std::vector<bspGridPointSH_t> ProbeIntegrator::Values(std::vector<ReceiverBatch> &blocks, std::uint64_t seed,
                                                      GridStats &work) const {
    std::vector<BlockSum> sums(blocks.size());
    lighting_.Trace(blocks, seed, work, [&](const BrickLight &one, const std::vector<ProbeIncidentLight> &incident) {
        const Vec3d scale = Vec3d(one.light->color) * ((one.light->negative ? -1 : 1) / 255.0);
        for (std::size_t block = 0; block < blocks.size(); ++block)
            if (incident[block].live.Any())
                sums[block].Add(scale, incident[block]);
    });
    const bool flood = in_.options.floodlight || in_.world.hasFloodlight;
    std::vector<bspGridPointSH_t> values;
    std::size_t count = 0;
    for (const ReceiverBatch &receivers : blocks)
        count += receivers.count;
    values.reserve(count);
    for (std::size_t block = 0; block < blocks.size(); ++block) {
        const ReceiverBatch &receivers = blocks[block];
        BlockSum &sum = sums[block];
        for (std::size_t i = 0; i < receivers.count && flood; ++i)
            AddFlood(in_, receivers, i, sum, work.counts);
        for (std::size_t i = 0; i < receivers.count && in_.indirect; ++i)
            AddIndirect(in_, receivers, i, sum, work.counts);
        StoreBlock(in_, sum, receivers.count, values);
    }
    return values;
}

} // namespace q3
