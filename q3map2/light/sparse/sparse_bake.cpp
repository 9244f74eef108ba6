// GPL-2.0-or-later. Bakes the sparse SH grid.
#include "q3map2/light/sparse/sparse_bake.h"

#include "q3map2/light/sparse/corner_fit.h"
#include "q3map2/light/sparse/display_error.h"
#include "q3map2/light/sparse/octree_prune.h"
#include "q3map2/light/sparse/octree_refine.h"
#include "q3map2/light/sparse/sparse_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace q3 {

namespace {

/// Refinement begins at this threshold (bytes^2 times smallest cells), which is divided by kThresholdStep until the
/// goal can be met, or until it is below kMinThreshold.
constexpr float kFirstThreshold = 16384, kThresholdStep = 2.5f, kMinThreshold = 1;
/// Leafs that a split adds.
constexpr float kLeafsPerSplit = 7;
/// Prices of a leaf (see PruneOctree): the lowest without refinement, and the highest. Bytes^2 times smallest cells.
constexpr float kMinPrice = 1.0f / 64, kMaxPrice = 1e9f;
/// The price is found by kBisections bisections, on a logarithmic scale, of a range from the lowest price that
/// refinement allows to kPriceRange times that.
constexpr float kPriceRange = 65536;
constexpr int kBisections = 14;
/// Refinement to an error target ends where a further leaf reduces the squared error by less than this share of the
/// mean squared error of a leaf.
constexpr double kMinGain = 0.25;
/// The price of a leaf grows by this factor while the lump exceeds its budget.
constexpr float kPriceStep = 1.15f;
/// Without a budget the lump has at most about this share of the bytes of the uniform grid, whatever its error: where
/// lamps are dense, no cells are small enough.
constexpr double kMaxShareOfUniform = 0.5;
/// Estimate of the bytes of the lump per leaf, for its point and its share of a node.
constexpr double kBytesPerLeaf = 25;

/// Refines and prunes an octree until it meets a goal. Keeps references.
class SparseGridBuilder {
  public:
    /// radiance: as light is stored, see ToDisplayed.
    SparseGridBuilder(const BspSpace &space, const JobPool &jobs, const SparseLattice &lattice, const SparseGoal &goal,
                      bool radiance)
        : space_(space), lattice_(lattice), goal_(goal), radiance_(radiance), light_(lattice), tree_(lattice),
          refiner_(space, jobs, lattice, tree_, light_) {}
    void Start(const LightGridSH &uniform) {
        refiner_.Start(uniform, radiance_);
        maxBytes_ = kMaxShareOfUniform * double(uniform.points.size() * sizeof(bspGridPointSH_t));
    }
    /// Makes Grid remove negative lobes from the values.
    void EnableDering() { dering_ = true; }
    /// Splits cells until pruning can meet the goal.
    void Refine(const LatticeTracer &tracer, GridStats &work) {
        for (float threshold = kFirstThreshold; threshold > kMinThreshold; threshold /= kThresholdStep) {
            refiner_.Refine(threshold, tracer, work);
            minPrice_ = threshold / kLeafsPerSplit;
            const PrunedOctree pruned = Pruned(minPrice_).second;
            if (IsFine(pruned) || (!goal_.budget && GainsLittle(pruned)))
                return;
        }
    }
    /// The grid of the coarsest tree that meets the goal; if none does, of the one nearest to it.
    SparseGridSH Grid(SparseStats &result);

  private:
    using PrunedTree = std::pair<Octree, PrunedOctree>;
    PrunedTree Pruned(float price) const {
        PrunedTree pruned{tree_, {}};
        pruned.second = PruneOctree(pruned.first, price);
        return pruned;
    }
    /// Whether the tree is fine enough for the goal.
    bool IsFine(const PrunedOctree &pruned) const {
        const double bytes = double(pruned.leafs) * kBytesPerLeaf;
        return goal_.budget ? bytes >= *goal_.budget : pruned.reducible <= double(goal_.error) || bytes >= maxBytes_;
    }
    /// Whether further leafs hardly reduce the error: most of it is in the smallest cells, beside lamps.
    bool GainsLittle(const PrunedOctree &pruned) const {
        return double(minPrice_) * double(pruned.leafs) < kMinGain * pruned.error * pruned.error * pruned.volume;
    }
    /// Highest price of a leaf at which the pruned tree is still fine.
    float FindPrice() const {
        float low = minPrice_, high = minPrice_ * kPriceRange;
        for (int i = 0; i < kBisections; ++i) {
            const float middle = std::sqrt(low * high);
            (IsFine(Pruned(middle).second) ? low : high) = middle;
        }
        return low;
    }
    SparseGridSH GridOf(const PrunedTree &pruned, SparseStats &result) const {
        CornerWeights corners(pruned.first, light_);
        const std::vector<ShFloats> values = FitCorners(pruned.first, light_, corners, lattice_, space_);
        SparseGridTree tree = MakeSparseTree(pruned.first, light_, corners, lattice_, values);
        DeringStats dering;
        for (bspGridPointSH_t &value : tree.values) {
            value = ToStored(std::bit_cast<ShFloats>(value), radiance_);
            if (dering_) {
                const DeringStats changed = DeringPoint(value, radiance_);
                dering.points += changed.points;
                dering.largestChange = std::max(dering.largestChange, changed.largestChange);
            }
        }
        SparseGridSH grid = PackSparseGrid(tree);
        result = {pruned.second.leafs, grid.points.size(), EncodeSparseGrid(grid).size(), pruned.second.error, dering};
        return grid;
    }

    const BspSpace &space_;
    const SparseLattice &lattice_;
    SparseGoal goal_;
    bool radiance_;
    LatticePoints light_;
    Octree tree_;
    OctreeRefiner refiner_;
    bool dering_ = false;
    double maxBytes_ = 0;        ///< without a budget: where refinement ends
    float minPrice_ = kMinPrice; ///< of a leaf: the tree is not refined for lower ones
};

SparseGridSH SparseGridBuilder::Grid(SparseStats &result) {
    float price = FindPrice();
    for (;;) {
        const PrunedTree pruned = Pruned(price);
        SparseGridSH grid = GridOf(pruned, result);
        if (!goal_.budget || double(result.bytes) <= *goal_.budget)
            return grid;
        price *= kPriceStep;
        if (price > kMaxPrice) // cells are as large as they can be
            return grid;
    }
}

} // namespace

SparseGridSH BakeSparseGrid(const GridInputs &in, const SmoothLight &light, const LightGridSH &uniform,
                            const SparseGoal &goal, GridStats &work, SparseStats &result) {
    const SparseLattice lattice(uniform.header);
    const LatticeTracer tracer(in, light, lattice);
    SparseGridBuilder builder(in.space, in.jobs, lattice, goal, in.options.shRadiance);
    if (in.options.shDering)
        builder.EnableDering();
    builder.Start(uniform);
    builder.Refine(tracer, work);
    return builder.Grid(result);
}

SparseGridSH SparseFromUniform(const BspSpace &space, const LightGridSH &uniform, bool radiance, const SparseGoal &goal,
                               const JobPool &jobs, SparseStats &result) {
    const SparseLattice lattice(uniform.header);
    SparseGridBuilder builder(space, jobs, lattice, goal, radiance);
    builder.Start(uniform);
    return builder.Grid(result);
}

void PrintSparseStats(const SparseStats &stats, const SparseGoal &goal, Log &log) {
    log.Count((long long)(stats.leafs), "cells with open space");
    log.Count((long long)(stats.stored), "points");
    log.Print("{:9.2f} MB\n", double(stats.bytes) / 1e6);
    log.Print("{:9.2f} of 255 is the expected error of interpolation\n", stats.error);
    constexpr double kShown = 1.1; // the price of leafs is found in steps
    if (!goal.budget && stats.error > kShown * double(goal.error))
        log.Print("That is above the {:g} that was asked for: smaller cells would hardly reduce it, or take more than "
                  "half of the bytes of the uniform grid\n",
                  goal.error);
    if (goal.budget && double(stats.bytes) > *goal.budget)
        log.Warn("SH grid budget",
                 "the sparse SH grid has {:.2f} MB with its largest cells, more than the {:g} of -shbudget",
                 double(stats.bytes) / 1e6, *goal.budget / 1e6);
}

} // namespace q3
