// GPL-2.0-or-later. Bakes the SH light grid that names lights.
#include "q3map2/light/named/named_bake.h"

#include "common/platform/platform.h"
#include "q3map2/light/named/named_cells.h"
#include "q3map2/light/named/named_fit.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace q3 {

namespace {

/// Thresholds of refinement: the first one, the factor by which they fall, and the last one. Bytes^2 times
/// kThresholdVolume game units^3.
constexpr float kFirstThreshold = 1024, kThresholdStep = 2.5f, kLastThreshold = 0.25f,
                kThresholdVolume = 32 * 32 * 64;
/// Leafs that a split adds: eight for one.
constexpr float kLeafsPerSplit = 7;
/// The price of a leaf is found by kBisections bisections, on a logarithmic scale, of kPriceRange.
constexpr int kBisections = 12;
constexpr float kPriceRange = 65536;
/// First guesses of the bytes of a leaf, and of the measured error over the expected one.
constexpr double kBytesPerLeaf = 36, kErrorRatio = 0.6;
/// At most so many grids are made to meet the goal as measured, to this factor.
constexpr int kMaxRounds = 3;
constexpr double kTargetSlack = 1.03, kBudgetUse = 0.97;

/// The lump of a tree.
NamedGridSH PackGrid(const Octree &tree, const NamedCells &cells, const CornerWeights &corners,
                     const std::vector<NamedValue> &values) {
    const StoredTree stored = StoreTree(tree, cells.Points(), corners);
    NamedGridSH grid;
    grid.mins = cells.Lattice().Mins().Array(), grid.cell = cells.Lattice().Cell().Array();
    grid.roots = cells.Lattice().Roots(), grid.levels = cells.Lattice().Levels();
    grid.table = cells.Table().Stored();
    std::span<const std::uint32_t> order = stored.order;
    for (const SparseGridNode &from : stored.nodes) {
        NamedGridNode node;
        node.inner = from.inner, node.stored = from.stored, node.hanging = from.hanging;
        const std::span<const std::uint32_t> points = order.first(std::size_t(std::popcount(from.stored)));
        order = order.subspan(points.size());
        std::vector<std::uint32_t> names;
        for (const std::uint32_t i : points)
            names.insert(names.end(), values[i].names.begin(), values[i].names.end());
        std::ranges::sort(names);
        names.erase(std::unique(names.begin(), names.end()), names.end());
        names.resize(std::min<std::size_t>(names.size(), 255));
        node.nameCount = std::uint8_t(names.size());
        grid.names.insert(grid.names.end(), names.begin(), names.end());
        for (const std::uint32_t i : points) {
            grid.points.push_back(QuantizeNamed(std::bit_cast<bspGridPointSH_t>(values[i].rest)));
            for (const std::uint32_t name : names) {
                const auto at = std::ranges::lower_bound(values[i].names, name);
                const bool has = at != values[i].names.end() && *at == name;
                grid.shares.push_back(has ? values[i].shares[std::size_t(at - values[i].names.begin())] : 0);
            }
        }
        grid.nodes.push_back(node);
    }
    NumberNamedNodes(grid);
    return grid;
}

/// Makes grids of a tree of cells, pruned to a goal. Keeps references.
class NamedGridBuilder {
  public:
    NamedGridBuilder(const GridInputs &in, NamedCells &cells, NamedStats &result)
        : in_(in), cells_(cells), result_(result) {}

    NamedGridSH Uniform() { return GridOf(cells_.Tree()); }
    NamedGridSH Adaptive(const ExactReceivers &exact, GridStats &work);

  private:
    struct PrunedTree {
        Octree tree;
        PruningStats stats;
    };
    PrunedTree Pruned(float price) const {
        PrunedTree pruned{cells_.Tree(), {}};
        pruned.stats = PruneOctree(pruned.tree, price);
        return pruned;
    }
    bool MeetsGoal(const PruningStats &stats) const {
        const SparseGoal &goal = in_.options.sparseGoal;
        return goal.budget ? double(stats.leafs) * bytesPerLeaf_ >= kBudgetUse * *goal.budget
                           : stats.error * errorRatio_ <= double(goal.error);
    }
    float FindPrice() const;
    NamedGridSH GridOf(const Octree &tree);

    const GridInputs &in_;
    NamedCells &cells_;
    NamedStats &result_;
    double bytesPerLeaf_ = kBytesPerLeaf, errorRatio_ = kErrorRatio;
    float minPrice_ = 0; ///< of a leaf: the tree is not refined for lower ones
};

NamedGridSH NamedGridBuilder::GridOf(const Octree &tree) {
    CornerWeights corners(tree, cells_.Points());
    const std::vector<NamedValue> values =
        FitNamedCorners(tree, cells_, corners, std::size_t(in_.options.shNames), in_.jobs);
    NamedGridSH grid = PackGrid(tree, cells_, corners, values);
    result_.lights = grid.table.lights.size(), result_.cells = tree.OpenLeafs().size();
    result_.points = grid.points.size(), result_.shares = grid.shares.size();
    result_.samples = cells_.Samples().size();
    result_.bytes = EncodeNamedGrid(grid).size();
    return grid;
}

/// The highest price at which the pruned tree meets an error, or uses a budget.
float NamedGridBuilder::FindPrice() const {
    float low = minPrice_, high = minPrice_ * kPriceRange;
    for (int i = 0; i < kBisections; ++i) {
        const float middle = std::sqrt(low * high);
        (MeetsGoal(Pruned(middle).stats) ? low : high) = middle;
    }
    return low;
}

NamedGridSH NamedGridBuilder::Adaptive(const ExactReceivers &exact, GridStats &work) {
    const Vec3f &cell = cells_.Lattice().Cell();
    const float unit = kThresholdVolume / (cell.x * cell.y * cell.z); // smallest cells
    float threshold = kFirstThreshold * unit;
    const auto refine = [&] {
        for (;; threshold /= kThresholdStep) {
            minPrice_ = threshold * kThresholdStep / kLeafsPerSplit;
            if (MeetsGoal(Pruned(minPrice_).stats) || threshold < kLastThreshold * unit)
                return;
            while (cells_.Split(threshold, work)) {
            }
        }
    };
    for (int round = 1;; ++round) {
        refine();
        const PrunedTree pruned = Pruned(FindPrice());
        NamedGridSH grid = GridOf(pruned.tree);
        result_.expectedError = pruned.stats.error;
        if (exact.Size() > 0)
            result_.measured = exact.ErrorOf(EncodeNamedGrid(grid));
        bytesPerLeaf_ = double(result_.bytes) / double(std::max<std::size_t>(1, pruned.stats.leafs));
        if (result_.measured && pruned.stats.error > 0)
            errorRatio_ = result_.measured->rms / pruned.stats.error;
        const SparseGoal &goal = in_.options.sparseGoal;
        const bool isDone = goal.budget ? double(result_.bytes) <= *goal.budget && double(result_.bytes) > 0.9 * *goal.budget
                                        : !result_.measured || result_.measured->rms <= kTargetSlack * double(goal.error);
        if (isDone || round == kMaxRounds || threshold < kLastThreshold * unit)
            return grid;
    }
}

} // namespace

NamedGridSH BakeNamedGrid(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
                          GridStats &work, NamedStats &result) {
    const LightTable table(lights, in.options.PositiveGridScale());
    const CpuTimer timer;
    double last = 0;
    const auto lap = [&](const char *what) { if (getenv("NTIME")) fprintf(stderr, "%8.2f %s\n", timer.Seconds() - last, what); last = timer.Seconds(); };
    NamedCells cells(in, layout, lights, table, in.options.shAdaptive ? CellSizes::Adaptive : CellSizes::Uniform);
    lap("tracer");
    cells.Start(work);
    lap("start");
    NamedGridBuilder builder(in, cells, result);
    if (!in.options.shAdaptive) {
        NamedGridSH grid = builder.Uniform();
        lap("grid");
        return grid;
    }
    std::vector<Light> steady = lights;
    std::erase_if(steady, [](const Light &light) { return light.style != 0; });
    const ExactReceivers exact(in, steady);
    lap("exact");
    NamedGridSH grid = builder.Adaptive(exact, work);
    lap("adaptive");
    return grid;
}

void PrintNamedStats(const NamedStats &stats, Log &log) {
    log.Count(stats.lights, "lights that points can name");
    log.Count(stats.cells, "cells with open space");
    log.Count(stats.samples, "positions inside cells");
    log.Count(stats.points, "points");
    log.Print("{:9.2f} names a point\n", double(stats.shares) / double(std::max<std::size_t>(1, stats.points)));
    log.Print("{:9.2f} MB\n", double(stats.bytes) / 1e6);
    if (stats.measured && stats.measured->receivers > 0)
        log.Print("{:9.2f} of 255 is the error of displayed light, measured at {} random positions of players (RMS)\n",
                  stats.measured->rms, stats.measured->receivers);
}

} // namespace q3
