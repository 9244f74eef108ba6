// GPL-2.0-or-later. The SH light grid: where its points are lit from, and their light.
#include "q3map2/light/grid/light_gridsh.h"

#include "q3map2/light/grid/gridsh_fill.h"
#include "q3map2/light/grid/gridsh_fit.h"
#include "q3map2/light/grid/probe_integrator.h"
#include "q3map2/light/grid/weak_field.h"
#include "libs/math/low_discrepancy.h"

#include <algorithm>
#include <cmath>

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

/// Where the points are lit from, and the state of each.
class LitPoints {
  public:
    LitPoints(const GridInputs &in, const GridLayout &layout, const GridBricks &bricks)
        : layout_(layout), states_(std::size_t(layout.Count()), PointState::Exterior), clusters_(states_.size()),
          litFrom_(states_.size()) {
        ForBricks(in, bricks, [&](std::int64_t, std::span<const BrickPoint> points) {
            for (const BrickPoint &point : points) {
                const PlacedPoint placed = PlaceInOpen(in.space, point.position);
                clusters_[point.index] = litFrom_[point.index] = placed.cluster;
                states_[point.index] = placed.state;
            }
        });
        std::vector<std::vector<DisplacedPoint>> displaced(std::size_t(bricks.Count()));
        ForBricks(in, bricks, [&](std::int64_t brick, std::span<const BrickPoint> points) {
            for (const BrickPoint &point : points) {
                if (states_[point.index] == PointState::Open)
                    continue;
                const PlacedPoint placed = PlaceGridPoint(in.space, layout, clusters_, point);
                states_[point.index] = placed.state;
                litFrom_[point.index] = placed.cluster;
                if (placed.cluster >= 0)
                    displaced[std::size_t(brick)].push_back({point.index, placed.position});
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
    bool IsLit(std::uint32_t index) const { return litFrom_[index] >= 0; }
    /// Adds a receiver for a point that is lit.
    void AddReceiver(const BrickPoint &point, std::vector<ReceiverBatch> &blocks) const {
        Vec3f from = point.position;
        if (states_[point.index] != PointState::Open && states_[point.index] != PointState::OnEmitter)
            from = std::lower_bound(displaced_.begin(), displaced_.end(), point.index,
                                    [](const DisplacedPoint &d, std::uint32_t i) { return d.index < i; })
                       ->position;
        BatchWithRoom(blocks).Add(from, from, litFrom_[point.index], point.index);
    }
    std::vector<PointState> &States() { return states_; }
    const std::vector<DisplacedPoint> &Displaced() const { return displaced_; }

  private:
    /// Calls use(brick, points) for all bricks, on all workers.
    template <typename Use> static void ForBricks(const GridInputs &in, const GridBricks &bricks, const Use &use) {
        in.jobs.For(bricks.Count(), [&](std::int64_t brick, int) { use(brick, bricks.Points(brick)); });
    }

    const GridLayout &layout_;
    std::vector<PointState> states_;
    std::vector<int> clusters_; ///< by point: of the point itself, see PlaceInOpen
    std::vector<int> litFrom_;  ///< by point: cluster that it is lit from; kSolidCluster: not lit
    std::vector<DisplacedPoint> displaced_;
};

/// Fills the weak light of a grid level by level, and traces the points that lower levels do not predict.
class SmoothLevels {
  public:
    SmoothLevels(const GridInputs &in, const GridLayout &layout, const LitPoints &points,
                 const ProbeIntegrator &integrator)
        : in_(in), layout_(layout), points_(points), integrator_(integrator) {}

    void Run(WeakField &weak, GridStats &stats) const {
        for (int level = 0; level < WeakField::kLevels; ++level) {
            const GridBricks bricks(layout_, level < 3 ? Int3{16, 16, 8} : Int3{16, 16, 4});
            RunBricks(in_, bricks.Count(), stats, [&](std::int64_t brick, GridStats &work) {
                TraceBrick(level, brick, bricks.Points(brick), weak, work);
            });
        }
    }

  private:
    struct LevelPoint {
        BrickPoint point;
        WeakField::Prediction prediction;
        std::uint32_t order;
    };

    void TraceBrick(int level, std::int64_t brick, const std::vector<BrickPoint> &points, WeakField &weak,
                    GridStats &work) const {
        std::vector<LevelPoint> traced;
        for (const BrickPoint &point : points) {
            const auto [x, y, z] = layout_.Coordinates(point.index);
            if (WeakField::LevelOf(x, y) != level || !points_.IsLit(point.index))
                continue;
            LevelPoint here{point, {}, Morton(x >> kShift[level], y >> kShift[level], z)};
            if (weak.IsOpen(point.index))
                here.prediction = weak.Predict(x, y, z);
            if (here.prediction.Good())
                weak.Accept(point.index, here.prediction), ++work.skippedSmooth;
            else
                traced.push_back(here);
        }
        if (traced.empty())
            return;
        std::stable_sort(traced.begin(), traced.end(),
                         [](const LevelPoint &a, const LevelPoint &b) { return a.order < b.order; });
        std::vector<ReceiverBatch> blocks;
        for (const LevelPoint &one : traced)
            points_.AddReceiver(one.point, blocks);
        integrator_.TraceWeak(blocks, HashIndex(std::uint64_t(brick * WeakField::kLevels + level)), work,
                              [&](std::size_t i, const WeakLight &light) {
                                  weak.SetTraced(traced[i].point.index, light, traced[i].prediction);
                              });
    }
    /// Interleaves the lowest bits: neighbors get near numbers.
    static std::uint32_t Morton(int x, int y, int z) {
        std::uint32_t code = 0;
        for (unsigned bit = 0; bit < 5; ++bit)
            code |= (unsigned(x) >> bit & 1) << 3 * bit | (unsigned(y) >> bit & 1) << (3 * bit + 1) |
                    (unsigned(z) >> bit & 1) << (3 * bit + 2);
        return code;
    }
    static constexpr int kShift[WeakField::kLevels] = {2, 2, 2, 1, 0};

    const GridInputs &in_;
    const GridLayout &layout_;
    const LitPoints &points_;
    const ProbeIntegrator &integrator_;
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
    lit.FindOnEmitters(layout, lights);
    const ProbeIntegrator integrator(in, lights);
    const VisibilityGroups sides = FindVisibilityGroups(in, layout, lit.Displaced(), lit.States());
    const DisplayedChange change(in.options.shRadiance, 255 * (in.options.gridScale > 0 ? in.options.gridScale : 1));
    WeakField weak(in.space, layout, lit.States(), change);
    if (in.options.skip.smooth)
        SmoothLevels(in, layout, lit, integrator).Run(weak, stats);
    const SmoothLight light(integrator, in.options.skip.smooth ? &weak : nullptr);
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
        fit.AddSamples(brick, fit.SampleCells(points, light, work));
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
