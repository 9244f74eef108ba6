// GPL-2.0-or-later. The SH light grid: the light of its points, and its form without negative lobes.
#include "q3map2/light/grid/light_gridsh.h"

#include "common/parallel.h"
#include "libs/math/morton.h"
#include "libs/sh/sh.h"
#include "q3map2/light/grid/gridsh_error.h"
#include "q3map2/light/grid/gridsh_fill.h"
#include "q3map2/light/grid/gridsh_fit.h"
#include "q3map2/light/grid/weak_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

namespace q3 {

// ---- The SH grid without negative lobes ----

void DeringStats::Add(const DeringStats &o) {
    points += o.points;
    largestChange = std::max(largestChange, o.largestChange);
}

DeringStats DeringPoint(bspGridPointSH_t &point, bool radiance) {
    std::array<SHVector, 3> channels;
    std::array<bool, 3> changed{};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        for (std::size_t k = 0; k < 9; ++k)
            channels[channel][k] = double(point.coeffs[k][channel]);
        changed[channel] = RemoveNegativeLobes(channels[channel]);
    }
    if (!changed[0] && !changed[1] && !changed[2])
        return {};
    const DisplayedLight before = DisplayLight(point, radiance);
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t k = 1; k < 9 && changed[channel]; ++k)
            point.coeffs[k][channel] = float(channels[channel][k]);
    const DisplayedLight after = DisplayLight(point, radiance);
    DeringStats stats{.points = 1};
    for (std::size_t i = 0; i < before.size(); ++i)
        stats.largestChange = std::max(stats.largestChange, double(std::abs(after[i] - before[i])));
    return stats;
}

DeringStats DeringGridSH(LightGridSH &grid, bool radiance, const JobPool &jobs) {
    constexpr std::size_t kPointsPerPart = 4096;
    const std::size_t parts = (grid.points.size() + kPointsPerPart - 1) / kPointsPerPart;
    std::vector<DeringStats> work(parts);
    jobs.For(std::int64_t(parts), [&](std::int64_t part, int) {
        DeringStats &partStats = work[std::size_t(part)];
        const std::size_t first = std::size_t(part) * kPointsPerPart;
        const std::size_t end = std::min(grid.points.size(), first + kPointsPerPart);
        for (std::size_t i = first; i < end; ++i)
            partStats.Add(DeringPoint(grid.points[i], radiance));
    });
    DeringStats total;
    for (const DeringStats &part : work)
        total.Add(part);
    return total;
}

// ---- The SH light grid: where its points are lit from, and their light ----

namespace {

/// A BSP file ends at 2 GiB, since its offsets are 32-bit integers. This much of it, in bytes, is left to the other
/// lumps, whose size is not known yet.
constexpr std::int64_t kRoomForOtherLumps = std::int64_t(1) << 28;
constexpr std::int64_t kMaxPointsSH =
    (std::numeric_limits<std::int32_t>::max() - kRoomForOtherLumps - std::int64_t(sizeof(bspGridSHHeader_t))) /
    std::int64_t(sizeof(bspGridPointSH_t));
static_assert(sizeof(bspGridSHHeader_t) == 40 && sizeof(bspGridPointSH_t) == 108);

/// Weak light at the points of a part is predicted from points up to this many bricks away on each axis. Where others
/// would be needed, the part traces more.
constexpr int kNearOwn = 1;

/// Pairs of a point and a light, or a ray of bounced light, from which on weak light is interpolated: fewer are traced
/// in a fraction of a second, and exact.
constexpr std::int64_t kLeastPairs = 1'000'000;

} // namespace

GridLayout LayoutGridSH(const Bsp &bsp, Float3 size) {
    const bspModel_t &model = bsp.models.front();
    GridLayout layout = LayoutGrid(model.mins, model.maxs, size);
    while (layout.Count() > kMaxPointsSH) {
        for (float &axis : size)
            axis += kMinCell;
        layout = LayoutGrid(model.mins, model.maxs, size);
    }
    return layout;
}

Float3 CellOfGridSH(const Float3 &legacySize, const LightOptions &options) {
    Float3 size{};
    for (std::size_t i = 0; i < 3; ++i) {
        const float wanted = options.gridSizeSH ? (*options.gridSizeSH)[i] : legacySize[i] / options.gridScaleSH;
        size[i] = std::max(kMinCell, wanted);
    }
    return size;
}

GridLayout SetupGridSH(const Bsp &bsp, const Float3 &legacySize, const LightOptions &options, Log &log) {
    Float3 size = CellOfGridSH(legacySize, options);
    const GridLayout layout = LayoutGridSH(bsp, size);
    const Float3 asked = std::exchange(size, layout.size);
    if (size != asked)
        log.Warn(
            "SH grid size",
            "an SH grid with cells of {} {} {} would exceed 1.75 GiB, its part of the 2 GiB of a .bsp; {} {} {} is "
            "used",
            asked[0], asked[1], asked[2], size[0], size[1], size[2]);
    log.Print("SH grid cells of {} {} {}\n", size[0], size[1], size[2]);
    log.Count(layout.Count(), "SH grid points");
    return layout;
}

GridSHTracer::GridSHTracer(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights)
    : in_(in), layout_(layout), lightCount_(lights.size()), bricks_(layout), lit_(in, layout, bricks_),
      integrator_(in, lights),
      weak_(in.space, layout, lit_.States(),
            DisplayedChange(in.options.shRadiance, 255 * in.options.PositiveGridScale()), in.jobs) {
    lit_.FindOnEmitters(lights);
    FindOwn();
}

void GridSHTracer::FindOwn() {
    if (!in_.units || !in_.units->IsPart())
        return;
    // The units are blocks of 2 x 2 x 2 bricks, which weak light is traced in, along a Morton curve: a part is compact,
    // so it has few neighbors.
    const Int3 bricks = bricks_.Bricks();
    std::map<std::uint64_t, double> costs; // by Morton code of the block
    const auto codeOf = [](int x, int y, int z) {
        return std::uint64_t(MortonCode(unsigned(x) / 2, unsigned(y) / 2, unsigned(z) / 2));
    };
    const auto forBricks = [&](const auto &use) {
        for (int z = 0; z < bricks[2]; ++z)
            for (int y = 0; y < bricks[1]; ++y)
                for (int x = 0; x < bricks[0]; ++x)
                    use(x, y, z, bricks_.Number({x, y, z}));
    };
    forBricks([&](int x, int y, int z, std::size_t brick) {
        double &cost = costs[codeOf(x, y, z)];
        for (const BrickPoint &point : bricks_.Points(std::int64_t(brick)))
            cost += lit_.IsLit(point.index) ? 1 : 0;
    });
    std::vector<double> inOrder;
    for (const auto &[code, cost] : costs)
        inOrder.push_back(cost);
    const std::vector<std::uint8_t> ownBlocks = in_.units->Own(inOrder, UnitStore::Division::Ranges);
    std::map<std::uint64_t, std::uint8_t> isOwn;
    for (auto own = ownBlocks.begin(); const auto &[code, cost] : costs)
        isOwn[code] = *own++;
    own_.assign(std::size_t(bricks_.Count()), 0);
    forBricks([&](int x, int y, int z, std::size_t brick) { own_[brick] = isOwn[codeOf(x, y, z)]; });
    nearOwn_.assign(own_.size(), 0);
    forBricks([&](int x, int y, int z, std::size_t brick) {
        for (int k = std::max(0, z - kNearOwn); k <= std::min(bricks[2] - 1, z + kNearOwn); ++k)
            for (int j = std::max(0, y - kNearOwn); j <= std::min(bricks[1] - 1, y + kNearOwn); ++j)
                for (int i = std::max(0, x - kNearOwn); i <= std::min(bricks[0] - 1, x + kNearOwn); ++i)
                    nearOwn_[brick] |= own_[bricks_.Number({i, j, k})];
    });
}

LightGridSH GridSHTracer::EmptyGrid(GridStats &stats) const {
    LightGridSH grid;
    grid.header = {layout_.mins, layout_.size, layout_.bounds, std::int32_t(layout_.Count())};
    grid.points = VectorInParallel<bspGridPointSH_t>(std::size_t(layout_.Count()), in_.jobs);
    stats.points = layout_.Count();
    return grid;
}

void GridSHTracer::FillWeak(GridStats &stats) {
    const auto isWanted = [this](const Int3 &at) {
        return nearOwn_.empty() || nearOwn_[bricks_.NumberOfPoint(at)] != 0;
    };
    usesWeak_ = in_.options.skip.smooth && HasMuchToTrace() &&
                WeakFieldTracer(in_, layout_, lit_, integrator_, isWanted).Fill(weak_, stats);
}

LightGridSH GridSHTracer::TracePointsOnly(GridStats &stats, LightObserver &observer) {
    LightGridSH grid = EmptyGrid(stats);
    FillWeak(stats);
    RunBricks(in_, bricks_.Count(), stats, [&](std::int64_t brick, GridStats &work) {
        TracePoints(bricks_.Points(brick), brick, grid, work, &observer);
    });
    return grid;
}

LightGridSH GridSHTracer::TraceGridSH(GridStats &stats, GridSHSteps *steps) {
    LightGridSH grid = EmptyGrid(stats);
    const VisibilityGroups groups = FindVisibilityGroups(in_, layout_, lit_.Displaced(), lit_.States());
    FillWeak(stats);
    const LightAtPositions light(integrator_, Weak());
    GridFit fit(in_, layout_, lit_.States(), groups.isSplit);
    RunBricks(in_, bricks_.Count(), stats, [&](std::int64_t brick, GridStats &work) {
        if (!IsOwn(brick))
            return;
        const std::vector<BrickPoint> points = bricks_.Points(brick);
        TracePoints(points, brick, grid, work);
        fit.AddSamples(brick, fit.SampleCells(points, light, work));
    });
    if (in_.units && in_.units->IsPart())
        return grid; // the rest needs all bricks
    if (steps)
        *steps = {lit_.States(), {}, lit_.Displaced(), groups, grid, {}};
    FillGridSH(in_, layout_, lit_.Displaced(), groups, lit_.States(), grid);
    if (steps)
        steps->states = lit_.States(), steps->filled = grid;
    fit.Solve(grid, in_.jobs);
    const auto &states = lit_.States();
    for (const PointState state : {PointState::Open, PointState::OnEmitter, PointState::Beside})
        stats.open += std::count(states.begin(), states.end(), state);
    stats.moved = std::count(states.begin(), states.end(), PointState::Moved);
    stats.filled = std::count(states.begin(), states.end(), PointState::Filled);
    return grid;
}

bool GridSHTracer::HasMuchToTrace() const {
    const std::int64_t rays = std::int64_t(lightCount_) + (in_.indirect ? in_.indirect->RaysPerPoint() : 0);
    return layout_.Count() * rays >= kLeastPairs;
}

void GridSHTracer::TracePoints(std::span<const BrickPoint> points, std::int64_t brick, LightGridSH &grid,
                               GridStats &work, LightObserver *observer) const {
    std::vector<ReceiverBatch> blocks;
    for (const BrickPoint &point : points)
        if (lit_.IsLit(point.index))
            lit_.AddReceiver(point, blocks);
    if (blocks.empty())
        return;
    const auto indexOf = [&](std::size_t i) { return blocks[i / kPacketSize].index[i % kPacketSize]; };
    const auto store = [&](std::size_t i, const bspGridPointSH_t &value) { grid.points[indexOf(i)] = value; };
    const auto weakOf = [&](std::size_t i) -> const WeakLight & { return weak_.At(indexOf(i)); };
    if (usesWeak_)
        integrator_.TraceStrong(blocks, std::uint64_t(brick), work, weakOf, store, observer);
    else
        integrator_.Trace(blocks, std::uint64_t(brick), work, store, observer);
}

} // namespace q3
