// GPL-2.0-or-later. The SH light grid: where its points are lit from, and their light.
#include "q3map2/light/grid/light_gridsh.h"

#include "q3map2/light/grid/gridsh_fill.h"
#include "q3map2/light/grid/gridsh_fit.h"
#include "q3map2/light/grid/probe_integrator.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace q3 {

namespace {

/// Engines hold lump lengths in 32-bit integers.
constexpr std::int64_t kMaxPointsSH = (0x7fffffffll - 40) / 108;

/// Points this near to a surface light's plane are in it. Game units.
constexpr float kOnEmitter = 1.0f / 64;

/// Whether p is on the polygon of a surface light.
bool OnEmitter(const Light &light, const Vec3f &p) {
    if (std::abs(Dot(Vec3f(light.shape.normal), p) - float(light.shape.dist)) > kOnEmitter)
        return false;
    bool left = false, right = false;
    for (std::size_t i = 0; i < light.w.size(); ++i) {
        const Vec3f &a = light.w[i], edge = light.w[(i + 1) % light.w.size()] - a;
        const float side = Dot(Cross(edge, p - a), Vec3f(light.shape.normal)), margin = kOnEmitter * Length(edge);
        left = left || side > margin, right = right || side < -margin;
    }
    return !(left && right);
}

/// The receivers of all points, by brick, and the state of each point.
class PointReceivers {
  public:
    PointReceivers(const GridInputs &in, const GridLayout &layout, const GridBricks &bricks)
        : states_(std::size_t(layout.Count()), PointState::Exterior), receivers_(std::size_t(bricks.Count())) {
        std::vector<int> clusters(states_.size());
        ForBricks(in, bricks, [&](std::int64_t, std::span<const BrickPoint> points) {
            for (const BrickPoint &point : points) {
                const PlacedPoint placed = PlaceInOpen(in.space, point.position);
                clusters[point.index] = placed.cluster;
                states_[point.index] = placed.state;
            }
        });
        std::vector<std::vector<DisplacedPoint>> displaced(receivers_.size());
        ForBricks(in, bricks, [&](std::int64_t brick, std::span<const BrickPoint> points) {
            for (const BrickPoint &point : points) {
                PlacedPoint placed{PointState::Open, point.position, clusters[point.index]};
                if (states_[point.index] != PointState::Open)
                    placed = PlaceGridPoint(in.space, layout, clusters, point);
                Add(placed, point, receivers_[std::size_t(brick)], displaced[std::size_t(brick)]);
            }
        });
        for (const auto &part : displaced)
            displaced_.insert(displaced_.end(), part.begin(), part.end());
        std::sort(displaced_.begin(), displaced_.end(),
                  [](const DisplacedPoint &a, const DisplacedPoint &b) { return a.index < b.index; });
    }
    void FindOnEmitters(const GridLayout &layout, const std::vector<Light> &lights) {
        for (const Light &light : lights) {
            if (light.type != LightType::Area)
                continue;
            const Boundsf box = WindingBounds(light.w);
            std::array<int, 3> first{}, last{};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const float cell = layout.size[axis], least = (box.mins[axis] - kOnEmitter - layout.mins[axis]) / cell;
                const float most = (box.maxs[axis] + kOnEmitter - layout.mins[axis]) / cell;
                const auto end = float(layout.bounds[axis]);
                first[axis] = int(std::ceil(std::clamp(least, 0.0f, end)));
                last[axis] = int(std::floor(std::clamp(most, -1.0f, end - 1)));
            }
            for (int z = first[2]; z <= last[2]; ++z)
                for (int y = first[1]; y <= last[1]; ++y)
                    for (int x = first[0]; x <= last[0]; ++x) {
                        PointState &state = states_[std::size_t(layout.Index(x, y, z))];
                        if (state == PointState::Open && OnEmitter(light, Vec3f(layout.Position(x, y, z))))
                            state = PointState::OnEmitter;
                    }
        }
    }
    /// Receivers of a brick that are to be lit; taken once.
    std::vector<ReceiverBatch> Take(std::int64_t brick) { return std::move(receivers_[std::size_t(brick)]); }
    std::vector<PointState> &States() { return states_; }
    const std::vector<DisplacedPoint> &Displaced() const { return displaced_; }

  private:
    /// Calls use(brick, points) for all bricks, on all workers.
    template <typename Use> static void ForBricks(const GridInputs &in, const GridBricks &bricks, const Use &use) {
        in.jobs.For(bricks.Count(), [&](std::int64_t brick, int) { use(brick, bricks.Points(brick)); });
    }
    void Add(const PlacedPoint &placed, const BrickPoint &point, std::vector<ReceiverBatch> &receivers,
             std::vector<DisplacedPoint> &displaced) {
        states_[point.index] = placed.state;
        if (placed.cluster < 0)
            return;
        if (placed.state != PointState::Open)
            displaced.push_back({point.index, placed.position});
        BatchWithRoom(receivers).Add(placed.position, placed.position, placed.cluster, point.index);
    }

    std::vector<PointState> states_;
    std::vector<std::vector<ReceiverBatch>> receivers_;
    std::vector<DisplacedPoint> displaced_;
};

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

GridLayout SetupGridSH(const Bsp &bsp, const Float3 &legacySize, const LightOptions &options, Log &log) {
    Float3 size{};
    for (std::size_t i = 0; i < 3; ++i) {
        const float wanted = options.gridSizeSH ? (*options.gridSizeSH)[i] : legacySize[i] / options.gridScaleSH;
        size[i] = std::max(kMinCell, wanted);
    }
    const GridLayout layout = LayoutGridSH(bsp, size);
    const Float3 asked = std::exchange(size, layout.size);
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
    PointReceivers receivers(in, layout, bricks);
    receivers.FindOnEmitters(layout, lights);
    const ProbeIntegrator integrator(in, lights);
    const VisibilityGroups sides = FindVisibilityGroups(in, layout, receivers.Displaced(), receivers.States());
    GridFit fit(in, layout, receivers.States(), sides.isSplit);
    RunBricks(in, bricks.Count(), stats, [&](std::int64_t brick, GridStats &work) {
        std::vector<ReceiverBatch> blocks = receivers.Take(brick);
        if (!blocks.empty())
            integrator.Trace(blocks, std::uint64_t(brick), work,
                             [&](std::uint32_t index, const bspGridPointSH_t &value) { grid.points[index] = value; });
        fit.AddSamples(brick, fit.SampleCells(bricks.Points(brick), integrator, work));
    });
    FillGridSH(in, layout, receivers.Displaced(), sides, receivers.States(), grid);
    fit.Solve(grid, in.jobs);
    const auto &states = receivers.States();
    for (const PointState state : {PointState::Open, PointState::OnEmitter, PointState::Beside})
        stats.open += std::count(states.begin(), states.end(), state);
    stats.moved = std::count(states.begin(), states.end(), PointState::Moved);
    stats.filled = std::count(states.begin(), states.end(), PointState::Filled);
    return grid;
}

} // namespace q3
