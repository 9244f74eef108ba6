// GPL-2.0-or-later. SH coefficients at points in the open, and their arithmetic.
#include "q3map2/light/grid/probe_integrator.h"

#include "libs/sh/sh.h"
#include "q3map2/light/grid/grid_bricks.h"
#include "q3map2/units/unit_bytes.h"

#include <algorithm>
#include <numbers>

namespace q3 {

namespace {

/// Limit of coefficients, reached only with absurd keys and scales. 1 = byte 255.
constexpr double kMaxCoefficient = 1e9;

/// Stored coefficients of one channel at the receivers of a block.
using StoredChannel = std::array<Lanes, 9>;

/// sum += scale * coefficients, for the three channels at once: the coefficients are read once.
void AddScaled(const ProbeIncidentLight &incident, const Vec3d &scale, ChannelSums &sum) {
    Vectorize([&]() Q3_INLINE {
        const auto [red, green, blue] = scale;
        for (std::size_t k = 0; k < 9; ++k)
            Q3_INDEPENDENT
        for (const std::size_t i : kEachLane) {
            const double coefficient = double(incident.shCoeffs[k][i]);
            sum[0][k][i] += red * coefficient;
            sum[1][k][i] += green * coefficient;
            sum[2][k][i] += blue * coefficient;
        }
    });
}

/// The same for one channel of tinted light.
void AddTinted(const ProbeIncidentLight &incident, const Lanes &tint, double scale, ChannelSum &sum) {
    for (const std::size_t i : kEachLane)
        for (std::size_t k = 0; k < 9 && incident.live[i] != 0; ++k)
            sum[k][i] += scale * double(tint[i]) * double(incident.shCoeffs[k][i]);
}

/// Adds a light. scale: its color, 1 = byte 255.
void AddLight(const Vec3d &scale, const ProbeIncidentLight &incident, ChannelSums &sum) {
    if (!incident.tinted)
        return AddScaled(incident, scale, sum);
    const Lanes *tints[] = {&incident.tint.x, &incident.tint.y, &incident.tint.z};
    for (std::size_t channel = 0; channel < 3; ++channel)
        AddTinted(incident, *tints[channel], scale[channel], sum[channel]);
}

/// Adds floodlight: uniform light from the hemispheres around +z and -z. Light L on a surface that faces one is
/// radiance L / pi. The integrals of Y[0] and Y[2] over a hemisphere are 2 pi kSHC0 and +-pi kSHC1, those of band 2 are
/// 0.
void AddFlood(const GridInputs &in, const ReceiverBatch &receivers, std::size_t i, ChannelSums &sum,
              RayCounts &counts) {
    const Vec3f position = receivers.position[i];
    for (const float up : {1.0f, -1.0f}) {
        const float fraction =
            FloodFraction(in.scene, position, up, in.world.floodDistance, in.floodDirections, counts);
        const Vec3d light = Vec3d(in.world.floodColor) * (double(in.world.floodIntensity) * fraction / 255);
        const double convolve0 = StoredFactor(0, in.options.shRadiance) / std::numbers::pi;
        const double convolve1 = StoredFactor(2, in.options.shRadiance) / std::numbers::pi;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            sum[channel][0][i] += light[channel] * convolve0 * kSHC0 * 2 * std::numbers::pi;
            sum[channel][2][i] += light[channel] * convolve1 * kSHC1 * std::numbers::pi * up;
        }
    }
}

/// Adds bounced light.
void AddIndirect(const GridInputs &in, const ReceiverBatch &receivers, std::size_t i, ChannelSums &sum,
                 RayCounts &counts) {
    std::vector<IndirectRay> rays;
    in.indirect->Gather(receivers.rayOrigin[i], receivers.index[i], rays);
    counts.rays += rays.size();
    for (const IndirectRay &ray : rays) {
        const SHVector basis = SHBasis(Vec3d(ray.direction));
        for (std::size_t k = 0; k < 9; ++k) {
            const double weight = basis[k] * StoredFactor(k, in.options.shRadiance) / 255;
            for (std::size_t channel = 0; channel < 3; ++channel)
                sum[channel][k][i] += weight * double(ray.light[channel]);
        }
    }
}

/// Ambient and minimum light of a channel in units of coefficient 0, and the factor for all coefficients.
struct ChannelScale {
    double ambient, least, scale;
};

/// Coefficients of a channel to store; where its mean is negative, zero plus minimum light.
void StoreChannel(const ChannelSum &sum, const ChannelScale &channel, StoredChannel &stored) {
    Vectorize([&]() Q3_INLINE {
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
    });
}

/// Appends the values of a block, with ambient light, minimum light and grid scale applied.
void StoreBlock(const GridInputs &in, const ChannelSums &sum, std::size_t count,
                std::vector<bspGridPointSH_t> &values) {
    // Coefficient 0 of irradiance 1 from all sides, or of its radiance, 1 / pi: a constant c is c / Y[0] times Y[0].
    const double uniform = 1 / kSHC0 / (in.options.shRadiance ? std::numbers::pi : 1);
    std::array<StoredChannel, 3> stored;
    for (std::size_t channel = 0; channel < 3; ++channel)
        StoreChannel(sum[channel],
                     {double(in.world.ambient[channel]) / 255 * uniform,
                      double(in.world.minGrid[channel]) / 255 * uniform, in.options.PositiveGridScale()},
                     stored[channel]);
    for (std::size_t i = 0; i < count; ++i) {
        bspGridPointSH_t &point = values.emplace_back();
        for (std::size_t k = 0; k < 9; ++k)
            point.coeffs[k] = {stored[0][k][i], stored[1][k][i], stored[2][k][i]};
    }
}

} // namespace

ProbeIntegrator::ProbeIntegrator(const GridInputs &in, const std::vector<Light> &lights)
    : in_(in), lighting_(in, lights, in.options.shRadiance ? SHQuantity::Radiance : SHQuantity::Irradiance,
                         in.options.skip.smooth ? LightSplit::WeakAndStrong : LightSplit::None) {}

// ---- Units: the sums of a brick ----

namespace {

/// Sums of the receivers of blocks, without the lanes that have none.
std::vector<std::byte> BytesOfSums(std::span<const ReceiverBatch> blocks, std::span<const ChannelSums> sums) {
    UnitWriter writer;
    std::vector<double> values;
    for (std::size_t block = 0; block < blocks.size(); ++block)
        for (const ChannelSum &channel : sums[block])
            for (const DoubleLanes &lanes : channel)
                values.insert(values.end(), lanes.begin(), lanes.begin() + std::ptrdiff_t(blocks[block].count));
    const bool isDark = std::ranges::all_of(values, [](double value) { return value == 0; });
    writer.PutAll(isDark ? std::vector<double>() : values);
    return writer.Take();
}

/// False: the bytes are of other blocks.
bool ReadSums(std::span<const std::byte> bytes, std::span<const ReceiverBatch> blocks, std::vector<ChannelSums> &sums) {
    UnitReader reader(bytes);
    std::vector<double> values;
    reader.GetAll(values);
    std::size_t count = 0;
    for (const ReceiverBatch &block : blocks)
        count += 3 * 9 * block.count;
    if (!reader.IsComplete() || (!values.empty() && values.size() != count))
        return false;
    auto next = values.begin();
    for (std::size_t block = 0; block < blocks.size() && !values.empty(); ++block)
        for (ChannelSum &channel : sums[block])
            for (DoubleLanes &lanes : channel) {
                std::copy_n(next, blocks[block].count, lanes.begin());
                next += std::ptrdiff_t(blocks[block].count);
            }
    return true;
}

} // namespace

void ProbeIntegrator::AddSurroundings(std::span<const ReceiverBatch> blocks, std::vector<ChannelSums> &sums,
                                      GridStats &work) const {
    const bool flood = in_.options.floodlight || in_.world.hasFloodlight;
    for (std::size_t block = 0; block < blocks.size(); ++block) {
        const ReceiverBatch &receivers = blocks[block];
        for (std::size_t i = 0; i < receivers.count && flood; ++i)
            AddFlood(in_, receivers, i, sums[block], work.counts);
        for (std::size_t i = 0; i < receivers.count && in_.indirect; ++i)
            AddIndirect(in_, receivers, i, sums[block], work.counts);
    }
}

std::vector<ChannelSums> ProbeIntegrator::Sums(std::vector<ReceiverBatch> &blocks, std::uint64_t seed, LightPart part,
                                               GridStats &work, LightObserver *observer) const {
    const LightsInReach lights = lighting_.InReach(BrickExtent(blocks), seed, part, work);
    std::vector<ChannelSums> sums(blocks.size());
    UnitStore *const units = observer ? nullptr : in_.units;
    const bool isCache = units && units->IsCache();
    Hash128 key;
    bool isTouched = false;
    if (units) {
        LightUnitKey unit("SH sums", lighting_.Hashes(), *units);
        unit.AddReceivers(std::span<const ReceiverBatch>(blocks));
        unit.More().Add(part, lights.HasManyFaint());
        if (isCache)
            for (const WeightedLight &one : lights.List())
                unit.AddLight(*one.light, one.weight);
        else
            unit.More().Add(seed);
        key = unit.Key();
        isTouched = unit.IsTouched();
    }
    // A cache keeps direct light alone, since bounced light depends on all surfaces.
    const bool storesAll = units && !isCache;
    const bool addsSurroundings = part != LightPart::Strong;
    if (const auto known = units && !isTouched ? units->Find(key) : std::nullopt;
        known && ReadSums(*known, blocks, sums)) {
        if (addsSurroundings && !storesAll)
            AddSurroundings(blocks, sums, work);
        return sums;
    }
    const auto add = [&](const WeightedLight &one, const std::vector<ProbeIncidentLight> &incident) {
        const Vec3d scale = Vec3d(one.light->color) * ((one.light->negative ? -1 : 1) / 255.0);
        // Lights with a style change in the game: the observer keeps them apart.
        for (std::size_t block = 0; block < blocks.size() && one.light->style == 0; ++block)
            if (incident[block].live.Any())
                AddLight(scale, incident[block], sums[block]);
        if (observer)
            observer->See(one, blocks, incident);
    };
    lighting_.Trace(blocks, lights, part, work, add);
    if (isCache)
        units->Keep(key, BytesOfSums(blocks, sums));
    if (addsSurroundings)
        AddSurroundings(blocks, sums, work);
    if (storesAll)
        units->Keep(key, BytesOfSums(blocks, sums));
    return sums;
}

std::vector<bspGridPointSH_t> ProbeIntegrator::Values(std::span<const ReceiverBatch> blocks,
                                                      std::span<const ChannelSums> sums) const {
    std::vector<bspGridPointSH_t> values;
    values.reserve(blocks.size() * kPacketSize);
    for (std::size_t block = 0; block < blocks.size(); ++block)
        StoreBlock(in_, sums[block], blocks[block].count, values);
    return values;
}

bspGridPointSH_t ProbeIntegrator::LightAt(const ChannelSums &sums, std::size_t lane) {
    bspGridPointSH_t light;
    for (std::size_t k = 0; k < 9; ++k)
        for (std::size_t channel = 0; channel < 3; ++channel)
            light.coeffs[k][channel] = float(sums[channel][k][lane]);
    return light;
}

void ProbeIntegrator::AddLightAt(const bspGridPointSH_t &light, std::size_t lane, ChannelSums &sums) {
    for (std::size_t k = 0; k < 9; ++k)
        for (std::size_t channel = 0; channel < 3; ++channel)
            sums[channel][k][lane] += double(light.coeffs[k][channel]);
}

} // namespace q3
