// GPL-2.0-or-later. The SH light grid: placement, and light at every point in the open.
#include "q3map2/light/gridsh_fill.h"
#include "q3map2/light/gridsh_fit.h"
#include "q3map2/light/gridsh_light.h"
#include "q3map2/light/light_grid.h"

#include <algorithm>

namespace q3 {

namespace {

constexpr float kMinCell = 8;
/// Engines hold lump lengths in 32-bit integers.
constexpr std::int64_t kMaxPoints = (0x7fffffffll - 40) / 108;

/// Where points are lit from, and which of them are.
class PointPlaces {
  public:
    PointPlaces(const GridInputs &in, const GridLayout &layout, const GridBricks &bricks)
        : states_(std::size_t(layout.Count()), PointState::Void), places_(std::size_t(bricks.Count())) {
        std::vector<std::vector<Displacement>> displaced(places_.size());
        in.jobs.For(bricks.Count(), [&](std::int64_t brick, int) {
            for (const BrickPoint &point : bricks.Points(brick)) {
                const PlacedPoint placed = PlaceGridPoint(in.space, layout, point.position);
                states_[point.index] = placed.state;
                if (placed.cluster < 0)
                    continue;
                if (placed.state != PointState::Open)
                    displaced[std::size_t(brick)].push_back({point.index, placed.position});
                AddPlace(places_[std::size_t(brick)], placed.position, placed.position, placed.cluster, point.index);
            }
        });
        for (const auto &part : displaced)
            displaced_.insert(displaced_.end(), part.begin(), part.end());
        std::sort(displaced_.begin(), displaced_.end(),
                  [](const Displacement &a, const Displacement &b) { return a.index < b.index; });
    }
    /// Places of a brick that are to be lit; taken once.
    std::vector<LightPlaces> Take(std::int64_t brick) { return std::move(places_[std::size_t(brick)]); }
    std::vector<PointState> &States() { return states_; }
    const std::vector<Displacement> &Displaced() const { return displaced_; }

  private:
    std::vector<PointState> states_;
    std::vector<std::vector<LightPlaces>> places_;
    std::vector<Displacement> displaced_;
};

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
    while (layout.Count() > kMaxPoints) {
        for (float &axis : size)
            axis += kMinCell;
        layout = LayoutGrid(model.mins, model.maxs, size);
    }
    if (size != asked)
        log.Warn("SH grid size", "an SH grid with cells of {} {} {} passes the 2 GiB of a lump; {} {} {} is used",
                 asked[0], asked[1], asked[2], size[0], size[1], size[2]);
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
    PointPlaces places(in, layout, bricks);
    const PlaceLighter lighter(in, lights);
    const auto divided = DividedPoints(in, layout, places.Displaced(), places.States(), grid);
    GridFit fit(in, layout, places.States(), divided);
    RunGridBricks(in, bricks, stats, [&](std::int64_t brick, GridStats &work) {
        std::vector<LightPlaces> blocks = places.Take(brick);
        if (!blocks.empty())
            lighter.Trace(blocks, std::uint64_t(brick), work,
                          [&](std::uint32_t index, const bspGridPointSH_t &value) { grid.points[index] = value; });
        fit.AddSamples(brick, fit.SampleCells(bricks.Points(brick), lighter, work));
    });
    FillGridSH(in, layout, places.Displaced(), divided, places.States(), grid);
    fit.Solve(grid, in.jobs);
    const auto &states = places.States();
    stats.open = std::count(states.begin(), states.end(), PointState::Open) +
                 std::count(states.begin(), states.end(), PointState::Beside);
    stats.moved = std::count(states.begin(), states.end(), PointState::Moved);
    stats.filled = std::count(states.begin(), states.end(), PointState::Filled);
    return grid;
}

} // namespace q3
