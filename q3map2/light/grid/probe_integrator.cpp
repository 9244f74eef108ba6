// GPL-2.0-or-later. SH coefficients at any place in the open.
#include "q3map2/light/grid/probe_integrator.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// Lights fainter than this in all of a brick, and then at each point, are represented by a few of them. Byte scale; a
/// quarter of what a screen can show.
constexpr float kFaint = 1.0f / 4;

/// Sums beyond this, from absurd keys and scales, are cut. 1 = byte 255.
constexpr double kMaxCoefficient = 1e9;

/// Sums of what arrives at the receivers of a block, by coefficient, unit scale.
using ChannelSum = std::array<DoubleLanes, 9>;
using ShortSum = std::array<Lanes, 9>;

/// The three channels at once: the moments are read once.
Q3_VECTOR void AddScaled(const IncidentLight &incident, const Vec3f &scale, std::array<ShortSum, 3> &sum) {
    const auto [red, green, blue] = scale;
    for (std::size_t k = 0; k < 9; ++k) {
        float *r = sum[0][k].data(), *g = sum[1][k].data(), *b = sum[2][k].data();
        const float *moments = incident.shCoeffs[k].data();
#pragma GCC ivdep
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            r[i] += red * moments[i];
            g[i] += green * moments[i];
            b[i] += blue * moments[i];
        }
    }
}

/// Moves one sum to the other.
Q3_VECTOR void MoveSum(ShortSum &from, ChannelSum &to) {
    for (std::size_t k = 0; k < 9; ++k)
#pragma GCC ivdep
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            to[k][i] += double(from[k][i]);
            from[k][i] = 0;
        }
}

void AddTinted(const IncidentLight &incident, const Lanes &tint, double scale, ChannelSum &sum) {
    for (std::size_t i = 0; i < kPacketSize; ++i)
        for (std::size_t k = 0; k < 9 && incident.live[i] != 0; ++k)
            sum[k][i] += scale * double(tint[i]) * double(incident.shCoeffs[k][i]);
}

/// The same for a block of receivers. A few lights are added up in floats, which is twice as fast, before their sum is
/// added to that of all, so thousands of lights lose no more digits than one.
class BlockSum {
  public:
    /// scale: colour of the light, 1 = byte 255.
    void Add(const Vec3d &scale, const IncidentLight &incident) {
        if (!incident.tinted) {
            AddScaled(incident, Vec3f(scale), few_);
            if (++count_ == kFew)
                Flush();
            return;
        }
        const Lanes *tints[] = {&incident.tint.x, &incident.tint.y, &incident.tint.z};
        for (std::size_t channel = 0; channel < 3; ++channel)
            AddTinted(incident, *tints[channel], scale[channel], sum_[channel]);
    }
    /// After the last light.
    void Flush() {
        for (std::size_t channel = 0; channel < 3 && count_ > 0; ++channel)
            MoveSum(few_[channel], sum_[channel]);
        count_ = 0;
    }
    /// Adds light to place i.
    void Add(std::size_t i, std::size_t channel, std::size_t k, double light) { sum_[channel][k][i] += light; }
    const std::array<ChannelSum, 3> &Channels() const { return sum_; }

  private:
    static constexpr int kFew = 16; ///< lights that are added up in floats
    std::array<ShortSum, 3> few_{};
    std::array<ChannelSum, 3> sum_{};
    int count_ = 0; ///< lights in few_
};

/// A hemisphere of uniform light around +z or -z, as floodlight gives it.
void AddFlood(const GridInputs &in, const ReceiverBatch &receivers, std::size_t i, BlockSum &sum, RayCounts &counts) {
    const Vec3f position = receivers.position[i];
    for (const float up : {1.0f, -1.0f}) {
        const float share = FloodShare(in.scene, position, up, in.world.floodDistance, in.options.lowQuality, counts);
        const Vec3d light = Vec3d(in.world.floodColor) * (double(in.world.floodIntensity) * share / 255);
        const double convolve0 = in.options.shRadiance ? 1 / std::numbers::pi : kCosineLobe[0] / std::numbers::pi;
        const double convolve1 = in.options.shRadiance ? 1 / std::numbers::pi : kCosineLobe[2] / std::numbers::pi;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            sum.Add(i, channel, 0, light[channel] * convolve0 * kShC0 * 2 * std::numbers::pi);
            sum.Add(i, channel, 2, light[channel] * convolve1 * kShC1 * std::numbers::pi * up);
        }
    }
}

/// Bounced light.
void AddIndirect(const GridInputs &in, const ReceiverBatch &receivers, std::size_t i, BlockSum &sum,
                 RayCounts &counts) {
    std::vector<IndirectRay> rays;
    in.indirect->Gather(receivers.rayOrigin[i], receivers.index[i], rays);
    counts.rays += rays.size();
    const double share = IndirectLight::kFacing / 255.0 / double(rays.size());
    for (const IndirectRay &ray : rays) {
        if (ray.color == Vec3f{})
            continue;
        const ShVector basis = ShBasis(Vec3d(ray.direction));
        for (std::size_t k = 0; k < 9; ++k) {
            const double weight = basis[k] * (in.options.shRadiance ? 1 : kCosineLobe[k]) * share;
            for (std::size_t channel = 0; channel < 3; ++channel)
                sum.Add(i, channel, k, weight * double(ray.color[channel]));
        }
    }
}

/// What a channel adds to all light, what it has at least, and the factor of it as it is stored.
struct ChannelScale {
    double ambient, least, scale;
};

/// Values of a channel as they are stored; zero where its mean is negative.
Q3_VECTOR void StoreChannel(const ChannelSum &sum, const ChannelScale &channel, ShortSum &stored) {
    const auto [ambient, least, scale] = channel;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const double mean = sum[0][i] + ambient;
        stored[0][i] = float(std::min(std::max(mean < 0 ? 0 : mean, least) * scale, kMaxCoefficient));
    }
    for (std::size_t k = 1; k < 9; ++k)
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            const double value = sum[0][i] + ambient < 0 ? 0 : sum[k][i] * scale;
            stored[k][i] = float(std::min(std::max(value, -kMaxCoefficient), kMaxCoefficient));
        }
}

/// Appends the values of a block: with ambient light, the minimum and the grid scale.
void StoreBlock(const GridInputs &in, const BlockSum &sum, std::size_t count, std::vector<bspGridPointSH_t> &values) {
    // Coefficient 0 of light 1 from everywhere.
    const double uniform = 1 / kShC0 / (in.options.shRadiance ? std::numbers::pi : 1);
    std::array<ShortSum, 3> stored;
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
    : in_(in), lights_(lights), settings_{.pass = LightPass::GridSH,
                                          .sunOnly = in.options.sunOnly,
                                          .radiance = in.options.shRadiance,
                                          .samples = in.options.shSamples,
                                          .skip = in.options.skip},
      faint_(kFaint / in.options.shSamples) {}

std::vector<bspGridPointSH_t> ProbeIntegrator::Values(std::vector<ReceiverBatch> &blocks, std::uint64_t seed,
                                                      GridStats &work) const {
    StartFaintResiduals(blocks, faint_);
    std::vector<BlockSum> sums(blocks.size());
    std::vector<IncidentLight> incident(blocks.size());
    const BrickLights candidates(lights_, BrickView(blocks), seed, faint_, in_.options.skip, work);
    LightSettings pass = settings_;
    pass.faint = candidates.Many() ? faint_ : 0;
    for (const BrickLight &one : candidates.List()) {
        pass.skip.pvs = settings_.skip.pvs && !one.seenByAll;
        LightContributionToPoint(*one.light, one.weight, pass, in_.scene, blocks, incident, work.counts);
        const Vec3d scale = Vec3d(one.light->color) * ((one.light->negative ? -1 : 1) / 255.0);
        for (std::size_t block = 0; block < blocks.size(); ++block)
            if (incident[block].live.Any())
                sums[block].Add(scale, incident[block]);
    }
    const bool flood = in_.options.floodlight || in_.world.hasFloodlight;
    std::vector<bspGridPointSH_t> values;
    values.reserve(blocks.size() * kPacketSize);
    for (std::size_t block = 0; block < blocks.size(); ++block) {
        const ReceiverBatch &receivers = blocks[block];
        BlockSum &sum = sums[block];
        sum.Flush();
        for (std::size_t i = 0; i < receivers.count && flood; ++i)
            AddFlood(in_, receivers, i, sum, work.counts);
        for (std::size_t i = 0; i < receivers.count && in_.indirect; ++i)
            AddIndirect(in_, receivers, i, sum, work.counts);
        StoreBlock(in_, sum, receivers.count, values);
    }
    return values;
}

} // namespace q3
