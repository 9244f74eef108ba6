// GPL-2.0-or-later. Reference light at random positions of a map, by brute force.
#include "tools/measure/shbench/truth.h"

#include "common/error.h"
#include "libs/sh/sh.h"
#include "q3map2/light/grid/grid_bricks.h"
#include "q3map2/light/grid/light_grid.h"

#include <algorithm>
#include <cmath>

namespace q3::bench {

namespace {

constexpr int kMinRays = 4, kMaxRays = 65536; ///< to a piece of an area light
/// Pilot rays to a piece of an area light: proportional to its light, within limits.
constexpr double kPilotRaysPerByte = 16;
constexpr int kMinPilot = 4, kMaxPilot = 64;
constexpr int kTriesPerPosition = 20000; ///< at most

/// Rays n_i for each piece, so that the standard error of the sum of their light is the goal. n stratified rays across
/// a straight shadow edge have the standard error d n^-0.75 (Mitchell, 1996), d the deviation of one. The least sum of
/// n_i under the condition sum(d_i^2 n_i^-1.5) = goal^2 is at n_i = (sum(d_k^0.8) / goal^2)^(2/3) d_i^0.8.
std::vector<int> ShareRays(const std::vector<double> &deviations, double goal) {
    double sum = 0;
    for (const double deviation : deviations)
        sum += std::pow(deviation, 0.8);
    const double scale = std::pow(sum / (goal * goal), 1 / 1.5);
    std::vector<int> counts;
    for (const double deviation : deviations)
        counts.push_back(int(std::clamp(scale * std::pow(deviation, 0.8), double(kMinRays), double(kMaxRays))));
    return counts;
}

/// Standard deviation of the light over each piece as seen from p, from pilot rays. The result does not reuse them,
/// which would bias it.
std::vector<double> Deviations(const std::vector<AreaPiece> &pieces, const Vec3d &p, Random &random, PointRays &rays) {
    std::vector<int> clear(pieces.size()), cast(pieces.size());
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const double wanted = kPilotRaysPerByte * pieces[i].bound;
        cast[i] = SamplePiece(pieces[i], p, int(std::clamp(wanted, double(kMinPilot), double(kMaxPilot))), random, rays,
                              nullptr, &clear[i]);
    }
    rays.Flush();
    std::vector<double> deviations;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        // Moved towards 1/2, so that a few rays that all agree leave some deviation.
        const double share = (clear[i] + 0.25) / (cast[i] + 0.5);
        deviations.push_back(pieces[i].bound * std::sqrt(share * (1 - share)));
    }
    return deviations;
}

void AddFloodlight(const BenchMap &map, const Vec3f &position, DirectionSum &sum) {
    if (!map.options.floodlight && !map.world.hasFloodlight)
        return;
    RayCounts counts;
    const std::vector<Vec3f> directions = FloodDirections(map.options.lowQuality);
    for (const float up : {1.0f, -1.0f}) {
        const double share = FloodFraction(map.scene, position, up, map.world.floodDistance, directions, counts);
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const double light = double(map.world.floodColor[channel]) * double(map.world.floodIntensity) * share;
            for (std::size_t i = 0; i < kNormals; ++i)
                sum.light[channel][i] += light * (1 + Normals()[i].z * double(up)) / 2;
            // On normal n it gives light (1 +- n.z) / 2: the mean, a linear term, and no band 2.
            sum.projection[channel][0] += light / 2 / kSHC0;
            sum.projection[channel][2] += light / 2 / kSHC1 * double(up);
        }
    }
}

/// Applies ambient light, grid minimum and grid scale, and converts from byte scale to 1.0 = byte 255.
TruthPoint Finish(const BenchMap &map, const Vec3f &position, const DirectionSum &sum) {
    TruthPoint point;
    point.position = position;
    const double scale = double(map.options.PositiveGridScale()) / 255;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const double mean = sum.projection[channel][0] * kSHC0 + double(map.world.ambient[channel]);
        const double keep = mean < 0 ? 0 : 1; // negative lights cannot make the mean negative
        const double raised = std::max(keep * mean, double(map.world.minGrid[channel]));
        const double extra = raised - keep * sum.projection[channel][0] * kSHC0;
        for (std::size_t i = 0; i < kNormals; ++i)
            point.light[i][channel] = float((keep * sum.light[channel][i] + extra) * scale);
        for (std::size_t k = 0; k < 9; ++k)
            point.projection[k][channel] =
                float((keep * sum.projection[channel][k] + (k == 0 ? extra / kSHC0 : 0)) * scale);
    }
    return point;
}

} // namespace

std::vector<Vec3f> PlayerPositions(const Bsp &bsp, const BspSpace &space, std::string_view mapName, int count,
                                   std::uint64_t seed) {
    const bspModel_t &world = bsp.models.front();
    const Vec3f mins(world.mins), size = Vec3f(world.maxs) - mins;
    Random random(seed);
    std::vector<Vec3f> positions;
    for (std::int64_t tries = 0; int(positions.size()) < count; ++tries) {
        if (tries > std::int64_t(count) * kTriesPerPosition)
            throw Error("{}: found only {} of {} positions where a player can be", mapName, positions.size(), count);
        const float x = float(Unit(random)), y = float(Unit(random)), z = float(Unit(random));
        const Vec3f p = mins + size * Vec3f{x, y, z};
        if (space.ClusterAt(p, kPlayerHalfSize) >= 0 && space.PlayerFits(p))
            positions.push_back(p);
    }
    return positions;
}

TruthPoint TruthAt(const BenchMap &map, const Vec3f &position, std::uint64_t seed, double noiseGoal,
                   std::uint64_t &rayCount, double *noise) {
    const Vec3d p(position);
    constexpr std::uint32_t kPurpose = 0x51; // any number: other users of the seed get other sequences
    std::seed_seq mixed{std::uint32_t(seed), std::uint32_t(seed >> 32), kPurpose};
    Random random(mixed);
    PointRays rays(map.scene, p);
    DirectionSum single;
    std::array<DirectionSum, 2> halves;
    std::vector<AreaPiece> pieces;
    for (const Light &light : map.lights) {
        if (map.options.sunOnly && light.type != LightType::Sun)
            continue;
        if (light.type == LightType::Area)
            CutAreaLight(light, p, pieces);
        else if (light.type == LightType::Sun)
            rays.CastToSky(light, single);
        else if (const double add = PointLightAt(light, p); add > 0)
            rays.Cast(Vec3d(light.origin), Normalize(Vec3d(light.origin) - p),
                      Vec3d(light.color) * (light.negative ? -add : add), &single, nullptr);
    }
    rays.Flush();
    const std::vector<int> counts = ShareRays(Deviations(pieces, p, random, rays), noiseGoal);
    for (DirectionSum &half : halves)
        for (std::size_t i = 0; i < pieces.size(); ++i)
            SamplePiece(pieces[i], p, counts[i] / 2, random, rays, &half, nullptr);
    rays.Flush();
    rayCount += rays.Count();

    AddFloodlight(map, position, single);
    if (noise) {
        std::array<TruthPoint, 2> parts;
        for (std::size_t h = 0; h < 2; ++h) {
            DirectionSum sum = single;
            parts[h] = Finish(map, position, sum += halves[h]);
        }
        *noise = 0;
        for (std::size_t i = 0; i < kNormals; ++i)
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const double difference =
                    (Displayed(parts[0].light[i][channel]) - Displayed(parts[1].light[i][channel])) / 2;
                *noise += difference * difference;
            }
    }
    for (const DirectionSum &half : halves)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            for (std::size_t i = 0; i < kNormals; ++i)
                single.light[channel][i] += half.light[channel][i] / 2;
            for (std::size_t k = 0; k < 9; ++k)
                single.projection[channel][k] += half.projection[channel][k] / 2;
        }
    return Finish(map, position, single);
}

Truth MakeTruth(const BenchMap &map, const TruthSettings &settings, const JobPool &jobs) {
    constexpr std::uint64_t kSeedStride = 0x9E3779B97F4A7C15u; // 2^64 over the golden ratio
    const double start = CpuSeconds();
    const std::vector<Vec3f> positions = PlayerPositions(map, settings.positions, settings.seed);
    Truth truth;
    truth.points.resize(positions.size());
    std::vector<double> noise(positions.size());
    std::vector<std::uint64_t> rays(positions.size());
    jobs.For(std::int64_t(positions.size()), [&](std::int64_t i, int) {
        const auto n = std::size_t(i);
        const std::uint64_t seed = settings.seed * kSeedStride + n;
        truth.points[n] = TruthAt(map, positions[n], seed, settings.noise, rays[n], &noise[n]);
    });
    double sum = 0;
    for (std::size_t i = 0; i < noise.size(); ++i)
        sum += noise[i], truth.rays += rays[i];
    truth.noise = noise.empty() ? 0 : std::sqrt(sum / double(noise.size() * kNormals * 3));
    truth.cpuSeconds = CpuSeconds() - start;
    return truth;
}

} // namespace q3::bench
