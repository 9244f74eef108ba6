// GPL-2.0-or-later. Bakes the SH light grid that names lights.
#include "q3map2/light/named/named_bake.h"

#include "common/error.h"
#include "q3map2/light/named/named_cells.h"
#include "q3map2/light/named/named_fit.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace q3 {

namespace {

/// Thresholds of refinement: the first one, the factor by which they fall, and the last one. Unit: bytes^2 times
/// kThresholdVolume game units^3, which is the volume of a cell of 32 x 32 x 64.
constexpr float kFirstThreshold = 16384, kThresholdStep = 2.5f, kLastThreshold = 0.25f, kThresholdVolume = 32 * 32 * 64;
/// Leafs that a split adds: eight for one.
constexpr float kLeafsPerSplit = 7;
/// The price of a leaf (see PruneOctree) is found by kBisections bisections, on a logarithmic scale, of a range from
/// the lowest price that refinement allows to kPriceRange times that.
constexpr int kBisections = 12;
constexpr float kPriceRange = 65536;
/// First guesses of the bytes of the lump per leaf, and of the ratio of the measured error to the expected one.
constexpr double kBytesPerLeaf = 36, kErrorRatio = 0.6;
/// Without a budget the lump has at most this fraction of the bytes of the uniform grid of -gridsh, whose cells have
/// half the edge of the first cells here, or kSmallLump bytes if that is more.
constexpr double kMaxFractionOfUniform = 0.1, kSmallLump = 80e3;
/// Unless a goal is given, refinement ends when corners and samples together are this fraction of the points of that
/// uniform grid: that takes about as long as baking it.
constexpr double kMaxFractionTraced = 0.3;
/// Refinement to an error target ends where a further leaf reduces the squared error by less than this fraction of the
/// mean squared error of a leaf.
constexpr double kMinGain = 0.25;
/// At most kMaxRounds grids are made to meet the goal as measured, or kMostRounds while the lump is too large. A
/// measured error of kTargetSlack targets meets the goal.
constexpr int kMaxRounds = 3, kMostRounds = 10;
constexpr double kTargetSlack = 1.03;
/// Cells are made smaller until the estimated bytes reach the fraction kBudgetUse of the limit; a lump of more than
/// kLeastBudgetUse of the budget uses it well enough.
constexpr double kBudgetUse = 0.97, kLeastBudgetUse = 0.9;

/// The table without the lights that no point names. numbers: the new numbers, by number in `all`. Errors: more lights
/// than a lump can hold.
GridLights NamedLights(const GridLights &all, const std::vector<NamedValue> &values,
                       std::vector<std::uint16_t> &numbers) {
    std::vector<bool> isNamed(all.lights.size());
    for (const NamedValue &value : values)
        for (const std::uint32_t name : value.names)
            isNamed[name] = true;
    if (const auto count = std::ranges::count(isNamed, true); count > SHGRID_LIGHTS)
        throw Error("-shlights: points would name {} lights, more than {}", count, SHGRID_LIGHTS);
    GridLights kept;
    numbers.assign(isNamed.size(), 0);
    for (std::size_t i = 0; i < isNamed.size(); ++i) {
        if (!isNamed[i])
            continue;
        numbers[i] = std::uint16_t(kept.lights.size());
        GridLight light = all.lights[i];
        light.name = std::uint32_t(kept.text.size());
        kept.text += all.text.c_str() + all.lights[i].name;
        kept.text += '\0';
        light.firstPolygon = std::uint32_t(kept.polygons.size());
        for (std::uint32_t p = 0; p < light.polygonCount; ++p) {
            GridPolygon polygon = all.polygons[all.lights[i].firstPolygon + p];
            const auto vertices = std::span(all.vertices).subspan(polygon.firstVertex, polygon.vertexCount);
            polygon.firstVertex = std::uint32_t(kept.vertices.size());
            kept.vertices.insert(kept.vertices.end(), vertices.begin(), vertices.end());
            kept.polygons.push_back(polygon);
        }
        kept.lights.push_back(light);
    }
    return kept;
}

/// The grid of a tree. values: of the stored corners, in the order of corners.Stored().
NamedGridSH PackGrid(const Octree &tree, const NamedCells &cells, const CornerWeights &corners,
                     const std::vector<NamedValue> &values) {
    const StoredTree stored = StoreTree(tree, cells.Points(), corners);
    NamedGridSH grid;
    grid.mins = cells.Lattice().Mins().Array(), grid.cell = cells.Lattice().Cell().Array();
    grid.roots = cells.Lattice().Roots(), grid.levels = cells.Lattice().Levels();
    std::vector<std::uint16_t> numbers;
    grid.table = NamedLights(cells.Table().Stored(), values, numbers);
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
        node.nameCount = std::uint8_t(names.size());
        for (const std::uint32_t name : names)
            grid.names.push_back(numbers[name]);
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

/// Refines and prunes the cells until their grid meets the goal. Keeps references.
class NamedGridBuilder {
  public:
    /// points: number of points of the uniform grid of the first cells.
    NamedGridBuilder(const GridInputs &in, NamedCells &cells, std::int64_t points, NamedStats &result)
        : in_(in), cells_(cells), result_(result), uniformPoints_(8 * double(points)),
          maxBytes_(in.options.sparseGoal.budget.value_or(
              std::max(kSmallLump, kMaxFractionOfUniform * uniformPoints_ * double(sizeof(bspGridPointSH_t))))) {}

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
    /// Whether the estimated bytes of the lump reach its limit.
    bool IsFull(const PruningStats &stats) const {
        return tableBytes_ + double(stats.leafs) * bytesPerLeaf_ >= kBudgetUse * maxBytes_;
    }
    bool MeetsGoal(const PruningStats &stats) const {
        const SparseGoal &goal = in_.options.sparseGoal;
        return IsFull(stats) || (!goal.budget && stats.error * errorRatio_ <= double(goal.error));
    }
    /// Whether smaller cells would hardly reduce the error (kMinGain). Never with a budget.
    bool GainsLittle(const PruningStats &stats) const {
        return !in_.options.sparseGoal.budget &&
               double(minPrice_) * double(stats.leafs) < kMinGain * stats.error * stats.error * stats.volume;
    }
    /// Whether tracing more positions would take longer than baking the uniform grid, and no goal allows that.
    bool TakesLong() const {
        const double traced = double(cells_.Points().Size() + cells_.Samples().size());
        return !in_.options.sparseGoal.isGiven && traced > kMaxFractionTraced * uniformPoints_;
    }
    void Refine(GridStats &work);
    float FindPrice() const;
    NamedGridSH GridOf(const Octree &tree);

    const GridInputs &in_;
    NamedCells &cells_;
    NamedStats &result_;
    double bytesPerLeaf_ = kBytesPerLeaf, errorRatio_ = kErrorRatio;
    double tableBytes_ = 0; ///< of the table of lights in the last grid
    double uniformPoints_;  ///< of the uniform grid of -gridsh
    double maxBytes_;       ///< limit of the lump
    float threshold_ = 0;   ///< the next threshold, bytes^2 times smallest cells; 0: none yet
    float minPrice_ = 0;    ///< of a leaf: for lower ones the tree is not fine enough
};

NamedGridSH NamedGridBuilder::GridOf(const Octree &tree) {
    CornerWeights corners(tree, cells_.Points(), RulesOfCorners(tree, cells_, in_.jobs), in_.jobs);
    std::map<std::uint32_t, std::size_t> dropped;
    const std::vector<NamedValue> values =
        FitNamedCorners(tree, cells_, corners, std::size_t(in_.options.shNames), in_.jobs, dropped);
    result_.dropped.clear();
    for (const auto &[light, cellCount] : dropped)
        result_.dropped[cells_.Table().Label(light)] += cellCount;
    NamedGridSH grid = PackGrid(tree, cells_, corners, values);
    result_.lights = cells_.Table().Size(), result_.cells = tree.OpenLeafs().size();
    result_.points = grid.points.size(), result_.shares = grid.shares.size();
    result_.samples = cells_.Samples().size();
    result_.bytes = EncodeNamedGrid(grid).size();
    return grid;
}

/// The highest price at which the pruned tree is estimated to meet the goal.
float NamedGridBuilder::FindPrice() const {
    float low = minPrice_, high = minPrice_ * kPriceRange;
    for (int i = 0; i < kBisections; ++i) {
        const float middle = std::sqrt(low * high);
        (MeetsGoal(Pruned(middle).stats) ? low : high) = middle;
    }
    return low;
}

/// Splits cells until the pruned tree is estimated to meet the goal, or smaller cells would hardly help.
void NamedGridBuilder::Refine(GridStats &work) {
    const Vec3f &cell = cells_.Lattice().Cell();
    const float unit = kThresholdVolume / (cell.x * cell.y * cell.z);
    const auto splitAbove = [&](float threshold) {
        threshold_ = threshold, minPrice_ = threshold / kLeafsPerSplit;
        while (cells_.Split(threshold, work)) {
        }
    };
    if (threshold_ == 0) // before that, the tree says nothing of what smaller cells gain
        splitAbove(kFirstThreshold * unit);
    for (;;) {
        const PruningStats stats = Pruned(minPrice_).stats;
        if (MeetsGoal(stats) || threshold_ <= kLastThreshold * unit || GainsLittle(stats) || TakesLong())
            return;
        splitAbove(threshold_ / kThresholdStep);
    }
}

NamedGridSH NamedGridBuilder::Adaptive(const ExactReceivers &exact, GridStats &work) {
    const SparseGoal &goal = in_.options.sparseGoal;
    std::size_t lastLeafs = 0;
    for (int round = 1;; ++round) {
        Refine(work);
        const PrunedTree pruned = Pruned(FindPrice());
        NamedGridSH grid = GridOf(pruned.tree);
        if (exact.Size() > 0)
            result_.measured = ErrorOfNamedGrid(exact, grid);
        tableBytes_ =
            double(grid.table.lights.size() * sizeof(GridLight) + grid.table.polygons.size() * sizeof(GridPolygon) +
                   grid.table.vertices.size() * sizeof(Float3) + grid.table.text.size());
        bytesPerLeaf_ = (double(result_.bytes) - tableBytes_) / double(std::max<std::size_t>(1, pruned.stats.leafs));
        if (result_.measured && pruned.stats.error > 0)
            errorRatio_ = result_.measured->rms / pruned.stats.error;
        result_.isFull = IsFull(pruned.stats), result_.takesLong = TakesLong();
        const bool fits = double(result_.bytes) <= maxBytes_;
        const bool isGood = goal.budget
                                ? double(result_.bytes) > kLeastBudgetUse * maxBytes_
                                : !result_.measured || result_.measured->rms <= kTargetSlack * double(goal.error);
        const bool isLast = isGood || result_.isFull || pruned.stats.leafs == lastLeafs || round >= kMaxRounds;
        lastLeafs = pruned.stats.leafs;
        if ((fits && isLast) || round == kMostRounds)
            return grid;
    }
}

} // namespace

NamedGridSH BakeNamedGrid(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
                          GridStats &work, NamedStats &result) {
    const LightTable table(lights, in.options.PositiveGridScale());
    NamedCells cells(in, layout, lights, table, in.options.shAdaptive ? CellSizes::Adaptive : CellSizes::Uniform);
    cells.Start(work);
    NamedGridBuilder builder(in, cells, layout.Count(), result);
    if (!in.options.shAdaptive)
        return builder.Uniform();
    std::vector<Light> steady = lights;
    std::erase_if(steady, [](const Light &light) { return light.style != 0; });
    return builder.Adaptive(ExactReceivers(in, steady), work);
}

GridSHError ErrorOfNamedGrid(const ExactReceivers &exact, const NamedGridSH &grid) {
    NamedGridSH steady = grid;
    for (GridLight &light : steady.table.lights)
        if (light.style != 0)
            light.color = {};
    return exact.ErrorOf(EncodeNamedGrid(steady));
}

void PrintNamedStats(const NamedStats &stats, const SparseGoal &goal, Log &log) {
    log.Count(stats.lights, "lights that points can name");
    log.Count(stats.cells, "cells with open space");
    log.Count(stats.samples, "positions inside cells");
    log.Count(stats.points, "points");
    log.Print("{:9.2f} names per point\n", double(stats.shares) / double(std::max<std::size_t>(1, stats.points)));
    log.Print("{:9.2f} MB\n", double(stats.bytes) / 1e6);
    if (goal.budget && double(stats.bytes) > *goal.budget)
        log.Warn("SH grid budget", "the SH grid that names lights has {:.2f} MB, more than the {:g} of -shbudget",
                 double(stats.bytes) / 1e6, *goal.budget / 1e6);
    if (!stats.measured || stats.measured->receivers == 0)
        return;
    log.Print("{:9.2f} levels: RMS error of displayed light at {} random player positions\n", stats.measured->rms,
              stats.measured->receivers);
    constexpr double kUnmentioned = 1.1; // as of the sparse grid
    if (!goal.budget && stats.measured->rms > kUnmentioned * double(goal.error))
        log.Print("That is above the target of {:g}: {}\n", goal.error,
                  stats.isFull      ? "smaller cells would take more than a tenth of the bytes of the uniform grid, or "
                                      "0.08 MB if that is more"
                  : stats.takesLong ? "smaller cells would take longer than the uniform grid, which -sherrortarget or "
                                      "-shbudget allows"
                                    : "smaller cells would hardly reduce it");
}

} // namespace q3
