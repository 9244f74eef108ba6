// GPL-2.0-or-later. Light grids in bricks.
#include "q3map2/light/grid_bricks.h"

#include "common/progress.h"
#include "libs/math/low_discrepancy.h"

#include <atomic>

namespace q3 {

namespace {

constexpr std::array<int, 3> kBrick = {8, 8, 4};
constexpr std::array<int, 3> kBlock = {4, 2, 2};
/// Points this far behind the centre of a one-sided lamp, moved off by a unit, get nothing from it in either grid. Game
/// units.
constexpr float kBehind = 2;
/// So few faint lights are all taken.
constexpr std::ptrdiff_t kFewFaint = 32;
constexpr std::uint64_t kSeedFaint = 0x4661696E74ull;

bool CanReach(const Light &light, const BrickView &brick) {
    if (light.type != LightType::Sun) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (light.bounds.mins[axis] > brick.box.maxs[axis] || light.bounds.maxs[axis] < brick.box.mins[axis])
                return false;
        if (brick.box.Distance(light.origin) > light.envelope)
            return false;
    }
    if (light.type == LightType::Area && !light.twoSided) {
        const Vec3f n(light.normal);
        const Vec3f farthest{n.x > 0 ? brick.box.maxs.x : brick.box.mins.x,
                             n.y > 0 ? brick.box.maxs.y : brick.box.mins.y,
                             n.z > 0 ? brick.box.maxs.z : brick.box.mins.z};
        if (Dot(n, farthest) < light.dist - kBehind)
            return false;
    }
    return std::any_of(brick.clusters.begin(), brick.clusters.end(), [&](int c) { return light.SeenFrom(c); });
}

} // namespace

GridBricks::GridBricks(const GridLayout &layout) : layout_(layout) {
    count_ = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        bricks_[axis] = (layout.bounds[axis] + kBrick[axis] - 1) / kBrick[axis];
        count_ *= bricks_[axis];
    }
}

std::vector<BrickPoint> GridBricks::Points(std::int64_t brick) const {
    const int origin[3] = {int(brick % bricks_[0]) * kBrick[0], int(brick / bricks_[0] % bricks_[1]) * kBrick[1],
                           int(brick / bricks_[0] / bricks_[1]) * kBrick[2]};
    std::vector<BrickPoint> points;
    const int total = kBrick[0] * kBrick[1] * kBrick[2], inBlock = kBlock[0] * kBlock[1] * kBlock[2];
    points.reserve(std::size_t(total));
    for (int i = 0; i < total; ++i) {
        const int block = i / inBlock, inside = i % inBlock;
        const int x = origin[0] + block % (kBrick[0] / kBlock[0]) * kBlock[0] + inside % kBlock[0];
        const int rest = block / (kBrick[0] / kBlock[0]);
        const int y = origin[1] + rest % (kBrick[1] / kBlock[1]) * kBlock[1] + inside / kBlock[0] % kBlock[1];
        const int z = origin[2] + rest / (kBrick[1] / kBlock[1]) * kBlock[2] + inside / (kBlock[0] * kBlock[1]);
        if (x >= layout_.bounds[0] || y >= layout_.bounds[1] || z >= layout_.bounds[2])
            continue;
        const auto index =
            std::int64_t(x) + std::int64_t(layout_.bounds[0]) * (y + std::int64_t(layout_.bounds[1]) * z);
        points.push_back({Vec3f(layout_.Position(x, y, z)), std::uint32_t(index)});
    }
    return points;
}

BrickView::BrickView(std::span<const LightPlace> places) {
    for (const LightPlace &place : places) {
        box.Add(place.position);
        if (std::find(clusters.begin(), clusters.end(), place.cluster) == clusters.end())
            clusters.push_back(place.cluster);
    }
}

BrickLights::BrickLights(const std::vector<Light> &lights, const BrickView &brick, std::uint64_t seed, float faint,
                         const LightOptions &options, GridStats &work) {
    std::vector<float> bounds;
    for (const Light &light : lights) {
        if (!options.noSkip && !CanReach(light, brick)) {
            ++work.skippedLights;
            continue;
        }
        list_.push_back({&light});
        bounds.push_back(LightBound(light, brick.box));
    }
    const auto isFaint = [&](float bound) { return bound < faint; };
    if (options.noSkip || std::count_if(bounds.begin(), bounds.end(), isFaint) <= kFewFaint)
        return;
    many_ = true;
    double collected = UnitFromHash(HashIndex(kSeedFaint ^ seed)) * double(faint);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < list_.size(); ++i) {
        BrickLight one = list_[i];
        if (isFaint(bounds[i])) {
            collected += double(bounds[i]);
            if (collected < double(faint)) {
                ++work.skippedFaint;
                continue;
            }
            collected -= double(faint);
            one.weight = faint / bounds[i];
        }
        list_[kept++] = one;
    }
    list_.resize(kept);
}

float StartOfFaint(std::uint32_t index, float faint) {
    return float(UnitFromHash(HashIndex(kSeedFaint + index))) * faint;
}

void GridStats::Add(const GridStats &o) {
    open += o.open, moved += o.moved, filled += o.filled;
    skippedFaint += o.skippedFaint, skippedLights += o.skippedLights;
    counts += o.counts;
}

void RunGridBricks(const GridInputs &in, const GridBricks &bricks, GridStats &stats,
                   const std::function<void(std::int64_t, GridStats &)> &trace) {
    std::vector<GridStats> work(std::size_t(in.jobs.Threads()));
    Progress progress(in.log, bricks.Count());
    std::atomic<std::uint64_t> raysSoFar{0};
    in.jobs.For(
        bricks.Count(),
        [&](std::int64_t brick, int worker) {
            GridStats &mine = work[std::size_t(worker)];
            const std::uint64_t before = mine.counts.rays;
            trace(brick, mine);
            raysSoFar += mine.counts.rays - before;
        },
        [&](std::int64_t done) { progress.Update(done, raysSoFar); });
    progress.Finish();
    for (const GridStats &part : work)
        stats.Add(part);
    stats.seconds += progress.Seconds();
}

void GridStats::Print(Log &log, bool verbose) const {
    log.Count(open, "points in the open");
    if (moved + filled > 0) {
        log.Count(moved, "points in solids lit from the nearest open place");
        log.Count(filled, "points in solids filled from neighbours");
    }
    log.Count((long long)(counts.rays), "rays");
    if (!verbose)
        return;
    log.Count((long long)(counts.pairs), "pairs of point and light");
    log.Count((long long)(skippedLights), "pairs of brick and light out of sight or reach, skipped");
    log.Count((long long)(skippedFaint), "pairs of brick and light too faint, represented by others");
    log.Count((long long)(counts.skippedPvs), "pairs of point and light hidden by visibility data, skipped");
    log.Count((long long)(counts.skippedFacing), "pairs of point and light out of reach, cone or side, skipped");
    log.Count((long long)(counts.skippedFaint), "pairs of point and light too faint, represented by others");
    log.Count((long long)(counts.refined), "pairs of point and light partly hidden, refined");
    if (seconds > 0)
        log.Print("{:9.2f} million rays per second of the pass\n", double(counts.rays) / seconds / 1e6);
}

} // namespace q3
