// GPL-2.0-or-later. The SH light grid: where its points are lit from, and their light.
#include "q3map2/light/grid/light_gridsh.h"

#include "q3map2/light/grid/gridsh_fill.h"
#include "q3map2/light/grid/gridsh_fit.h"
#include "q3map2/light/grid/gridsh_smooth.h"

#include <algorithm>

namespace q3 {

namespace {

/// Engines hold lump lengths in 32-bit integers.
constexpr std::int64_t kMaxPointsSH = (0x7fffffffll - 40) / 108;

} // namespace

GridLayout SetupGridSH(const Bsp &bsp, const Float3 &legacySize, const LightOptions &options, Log &log) {
    Float3 size{};
    for (std::size_t i = 0; i < 3; ++i) {
        const float wanted = options.gridSizeSH ? (*options.gridSizeSH)[i] : legacySize[i] / options.gridScaleSH;
        size[i] = std::max(kMinCell, wanted);
    }
    const bspModel_t &model = bsp.models.front();
    GridLayout layout = LayoutGrid(model.mins, model.maxs, size);
    const Float3 asked = size;
    while (layout.Count() > kMaxPointsSH) {
        for (float &axis : size)
            axis += kMinCell;
        layout = LayoutGrid(model.mins, model.maxs, size);
    }
    if (size != asked)
        log.Warn("SH grid size",
                 "an SH grid with cells of {} {} {} exceeds the 2 GiB limit of a lump; {} {} {} is used", asked[0],
                 asked[1], asked[2], size[0], size[1], size[2]);
    log.Print("SH grid cells of {} {} {}\n", size[0], size[1], size[2]);
    log.Count(layout.Count(), "SH grid points");
    return layout;
}

LightGridSH TraceGridSH(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
                        GridStats &stats) {
    LightGridSH grid;
    grid.header = {layout.mins, layout.size, layout.bounds, std::int32_t(layout.Count())};
    grid.points.assign(std::size_t(layout.Count()), bspGridPointSH_t{});
    stats.points = layout.Count();

    const GridBricks bricks(layout);
    LitPoints lit(in, layout, bricks);
    lit.FindOnEmitters(lights);
    const ProbeIntegrator integrator(in, lights);
    const VisibilityGroups sides = FindVisibilityGroups(in, layout, lit.Displaced(), lit.States());
    const DisplayedChange change(in.options.shRadiance, 255 * (in.options.gridScale > 0 ? in.options.gridScale : 1));
    WeakField weak(in.space, layout, lit.States(), change);
    if (in.options.skip.smooth)
        SmoothLevels(in, layout, lit, integrator).Run(weak, stats);
    // Samples of cells where most is traced are cheaper to trace as a whole.
    const SmoothLight whole(integrator, nullptr), light(integrator, in.options.skip.smooth ? &weak : nullptr);
    GridFit fit(in, layout, lit.States(), sides.isSplit);
    RunBricks(in, bricks.Count(), stats, [&](std::int64_t brick, GridStats &work) {
        const std::vector<BrickPoint> points = bricks.Points(brick);
        std::vector<ReceiverBatch> blocks;
        for (const BrickPoint &point : points)
            if (lit.IsLit(point.index))
                lit.AddReceiver(point, blocks);
        const auto indexOf = [&](std::size_t i) { return blocks[i / kPacketSize].index[i % kPacketSize]; };
        const auto store = [&](std::size_t i, const bspGridPointSH_t &value) { grid.points[indexOf(i)] = value; };
        const auto weakOf = [&](std::size_t i) -> const WeakLight & { return weak.At(indexOf(i)); };
        if (!blocks.empty() && in.options.skip.smooth)
            integrator.TraceStrong(blocks, std::uint64_t(brick), work, weakOf, store);
        else if (!blocks.empty())
            integrator.Trace(blocks, std::uint64_t(brick), work, store);
        fit.AddSamples(brick, fit.SampleCells(points, weak.IsMostlySmooth(points) ? light : whole, work));
    });
    FillGridSH(in, layout, lit.Displaced(), sides, lit.States(), grid);
    fit.Solve(grid, in.jobs);
    const auto &states = lit.States();
    for (const PointState state : {PointState::Open, PointState::OnEmitter, PointState::Beside})
        stats.open += std::count(states.begin(), states.end(), state);
    stats.moved = std::count(states.begin(), states.end(), PointState::Moved);
    stats.filled = std::count(states.begin(), states.end(), PointState::Filled);
    return grid;
}

} // namespace q3
