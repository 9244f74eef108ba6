// GPL-2.0-or-later. Passes over light grids by bricks: neighboring points share a list of lights and packets of rays.
#include "q3map2/light/grid/grid_bricks.h"

#include "common/log.h"
#include "libs/math/sampling.h"
#include "q3map2/light/batch/form_factor.h"
#include "q3map2/light/batch/receivers.h"
#include "q3map2/light/transfer/light_contribution.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>

namespace q3 {

// ---- Floodlight: cheap light from wherever the surroundings are open ----

namespace {

constexpr float kIgnoreNear = 1.5f; ///< surfaces nearer than this do not count. Game units

} // namespace

std::vector<Vec3f> FloodDirections(bool lowQuality) {
    return HemisphereRings(kFloodElevations, lowQuality ? kRingAzimuths / 2 : kRingAzimuths);
}

float FloodFraction(const LightScene &scene, const Vec3f &p, float up, float distance,
                    std::span<const Vec3f> directions, RayCounts &counts) {
    double sum = 0;
    auto rays = MakeRayBatcher<char>([&](RayPacket &packet, std::span<const char> tags) {
        scene.TraceDistance(packet, kIgnoreNear, counts);
        for (std::size_t i = 0; i < tags.size(); ++i)
            sum += double(std::min(1.0f, packet.distance[i] / distance));
    });
    for (const Vec3f &d : directions) // up = -1: half a turn about the y axis
        rays.Add({}, p, {d.x * up, d.y, d.z * up}, distance);
    rays.Flush();
    return float(sum / double(directions.size()));
}

// ---- Statistics of a pass over a light grid ----

void GridStats::Add(const GridStats &o) {
    points += o.points, open += o.open, moved += o.moved, filled += o.filled;
    skippedFaint += o.skippedFaint, skippedReach += o.skippedReach, skippedPvs += o.skippedPvs;
    skippedSmooth += o.skippedSmooth;
    for (const auto &[style, count] : o.dropped)
        dropped[style] += count;
    counts += o.counts;
    seconds += o.seconds;
}

void GridStats::Print(Log &log) const {
    log.Count(open, "points in the open");
    if (moved > 0)
        log.Count(moved, "points in solids lit from the nearest open position");
    if (filled > 0)
        log.Count(filled, "points in solids filled from neighbors");
    log.Count(counts.rays, "rays");
    const auto count = [&](std::uint64_t number, const char *what) { log.VerboseCount(number, what); };
    count(skippedPvs, "pairs of brick and light hidden by visibility data, skipped (-noskippvs)");
    count(skippedReach, "pairs of brick and light out of reach, skipped (-noskipreach)");
    count(skippedFaint, "pairs of brick and light too faint, represented by others (-noskipfaint)");
    count(skippedSmooth, "points and samples with weak light interpolated (-noskipsmooth)");
    count(counts.pairs, "pairs of point and light");
    count(counts.skippedPvs, "hidden by visibility data, skipped (-noskippvs)");
    count(counts.skippedUnlit, "out of reach, cone or side");
    count(counts.skippedFaint, "too faint, represented by others (-noskipfaint)");
    count(counts.skippedProbes, "with a faint area light, judged by one ray (-noskipprobes)");
    count(counts.skippedMoments, "with a far area light, approximated by points (-noskipmoments)");
    count(counts.skippedCoarse, "with visibility taken from neighbors that agree (-noskipcoarse)");
    count(counts.refined, "with an area light partly hidden, refined");
    if (seconds > 0)
        log.Verbose("{:9.2f} million rays per second of the pass\n", double(counts.rays) / seconds / 1e6);
}

// ---- Bricks: blocks of grid points, and the lights that reach them ----

namespace {

constexpr std::array<int, 3> kBlock = {4, 2, 2}; ///< points of a block by axis
/// A one-sided area light gives nothing, in either grid, to points farther than this behind the plane through its
/// origin; that plane is 1 unit in front of the surface. Game units.
constexpr float kBehind = 2;
/// Up to this many faint lights of a brick are all kept.
constexpr std::ptrdiff_t kFewFaint = 32;
constexpr std::uint64_t kSeedFaint = 0x4661696E74ull; ///< "Faint" in ASCII

/// Whether the light can give anything to some point of the brick.
bool CanReach(const PassLights::Reach &light, const BrickExtent &brick) {
    if (!light.sun) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (light.bounds.mins[axis] > brick.box.maxs[axis] || light.bounds.maxs[axis] < brick.box.mins[axis])
                return false;
        if (brick.box.Distance(light.origin) > light.envelope)
            return false;
    }
    if (light.oneSided) {
        const Vec3f n(light.normal);
        const Vec3f farthest{n.x > 0 ? brick.box.maxs.x : brick.box.mins.x,
                             n.y > 0 ? brick.box.maxs.y : brick.box.mins.y,
                             n.z > 0 ? brick.box.maxs.z : brick.box.mins.z};
        if (Dot(n, farthest) < light.dist - kBehind)
            return false;
    }
    return true;
}

} // namespace

GridBricks::GridBricks(const GridLayout &layout, const Int3 &brick) : layout_(layout), brick_(brick) {
    count_ = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        bricks_[axis] = (layout.bounds[axis] + brick_[axis] - 1) / brick_[axis];
        count_ *= bricks_[axis];
    }
}

std::vector<BrickPoint> GridBricks::Points(std::int64_t brick) const {
    const int origin[3] = {int(brick % bricks_[0]) * brick_[0], int(brick / bricks_[0] % bricks_[1]) * brick_[1],
                           int(brick / bricks_[0] / bricks_[1]) * brick_[2]};
    std::vector<BrickPoint> points;
    const int total = brick_[0] * brick_[1] * brick_[2], inBlock = kBlock[0] * kBlock[1] * kBlock[2];
    points.reserve(std::size_t(total));
    for (int i = 0; i < total; ++i) {
        const int block = i / inBlock, inside = i % inBlock;
        const int x = origin[0] + block % (brick_[0] / kBlock[0]) * kBlock[0] + inside % kBlock[0];
        const int rest = block / (brick_[0] / kBlock[0]);
        const int y = origin[1] + rest % (brick_[1] / kBlock[1]) * kBlock[1] + inside / kBlock[0] % kBlock[1];
        const int z = origin[2] + rest / (brick_[1] / kBlock[1]) * kBlock[2] + inside / (kBlock[0] * kBlock[1]);
        if (x >= layout_.bounds[0] || y >= layout_.bounds[1] || z >= layout_.bounds[2])
            continue;
        points.push_back({Vec3f(layout_.Position(x, y, z)), std::uint32_t(layout_.Index(x, y, z))});
    }
    return points;
}

BrickExtent::BrickExtent(std::span<const ReceiverBatch> blocks) {
    for (const ReceiverBatch &receivers : blocks) {
        for (std::size_t i = 0; i < receivers.count; ++i)
            box.Add(receivers.position[i]);
        for (std::size_t i = 0; i < receivers.clusters.count; ++i)
            if (std::find(clusters.begin(), clusters.end(), receivers.clusters.number[i]) == clusters.end())
                clusters.push_back(receivers.clusters.number[i]);
    }
}

PassLights::PassLights(const std::vector<Light> &lights) : byCluster_(lights, SunsSeen::ByVisibility) {
    reach_.reserve(lights.size());
    for (const Light &light : lights)
        reach_.push_back({light.bounds, light.origin, light.normal, light.envelope, light.dist,
                          light.type == LightType::Sun, light.type == LightType::Area && !light.twoSided});
}

LightsInReach::LightsInReach(const PassLights &lights, const BrickExtent &brick, const Choice &choice,
                             const SkipOptions &skip, GridStats &work) {
    const float faint = choice.faint;
    const auto use = [&](std::size_t number) {
        if (skip.reach && !CanReach(lights.ReachOf(number), brick)) {
            ++work.skippedReach;
            return;
        }
        const Light &light = lights.Lights()[number];
        const float bound = LightBound(light, brick.box);
        if (!(bound <= choice.minBound) || light.style != 0)
            list_.push_back({&light, 1, bound});
    };
    if (skip.pvs)
        work.skippedPvs += lights.ByCluster().ForEach(brick.clusters, use);
    else
        for (std::size_t i = 0; i < lights.Lights().size(); ++i)
            use(i);
    const auto isFaint = [&](const WeightedLight &one) { return one.bound < faint && one.light->style == 0; };
    if (!skip.faint || std::count_if(list_.begin(), list_.end(), isFaint) <= kFewFaint)
        return;
    hasManyFaint_ = true;
    float faintResidual = float(UnitFromHash(HashIndex(kSeedFaint ^ choice.seed))) * faint;
    const std::size_t before = list_.size();
    std::size_t kept = 0;
    for (WeightedLight one : list_)
        if (!isFaint(one) || SelectFaintLight(faint, one.bound, faintResidual, one.weight))
            list_[kept++] = one;
    list_.resize(kept);
    work.skippedFaint += before - kept;
}

void StartFaintResiduals(std::vector<ReceiverBatch> &blocks, float faint) {
    for (ReceiverBatch &receivers : blocks)
        receivers.faintResidual = float(UnitFromHash(HashIndex(kSeedFaint + receivers.index[0]))) * faint;
}

void RunBricks(const GridInputs &in, std::int64_t count, GridStats &stats,
               const std::function<void(std::int64_t, GridStats &)> &trace, ShowProgress show) {
    const auto start = std::chrono::steady_clock::now();
    std::vector<GridStats> work(std::size_t(in.jobs.Threads()));
    std::optional<Progress> progress;
    if (show == ShowProgress::Yes)
        progress.emplace(in.log, count);
    std::atomic<std::uint64_t> raysSoFar{0};
    in.jobs.For(
        count,
        [&](std::int64_t brick, int worker) {
            GridStats &workerStats = work[std::size_t(worker)];
            const std::uint64_t before = workerStats.counts.rays;
            trace(brick, workerStats);
            raysSoFar += workerStats.counts.rays - before;
        },
        [&](std::int64_t done) {
            if (progress)
                progress->Update(done, raysSoFar);
        });
    if (progress)
        progress->Finish();
    for (const GridStats &part : work)
        stats.Add(part);
    stats.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

} // namespace q3
