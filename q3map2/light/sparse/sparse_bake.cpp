// GPL-2.0-or-later. The sparse SH grid.
#include "q3map2/light/sparse/sparse_bake.h"

#include "q3map2/light/sparse/corner_fit.h"
#include "q3map2/light/sparse/octree_prune.h"
#include "q3map2/light/sparse/octree_refine.h"
#include "q3map2/light/sparse/sparse_tree.h"

#include <cmath>

namespace q3 {

namespace {

/// Refinement begins at this threshold (bytes^2 times smallest cells), which is divided by kFiner until the goal is
/// reached, or until it is below kLeastThreshold.
constexpr float kFirstThreshold = 65536, kFiner = 1.7f, kLeastThreshold = 1;
/// Leafs that a split adds.
constexpr float kLeafsPerSplit = 7;
/// Bisections of the price of a leaf, on a logarithmic scale, between that of refinement and kMostPrice times that.
constexpr int kBisections = 6;
constexpr float kMostPrice = 16;
/// Bytes of the lump for each leaf: of points that are stored, and of nodes.
constexpr double kBytesPerLeaf = 25;

/// Refines and prunes an octree until it has the wanted error or size.
class SparsePlan {
  public:
    SparsePlan(const GridInputs &in, const SparseLattice &lattice, LatticeLight &light)
        : options_(in.options), tree_(lattice), refiner_(in, lattice, tree_, light) {}

    /// The pruned tree.
    Octree Make(const LightGridSH &uniform, GridStats &work, PrunedOctree &pruned) {
        refiner_.Start(uniform);
        float threshold = kFirstThreshold;
        for (;;) {
            refiner_.Refine(threshold, work);
            price_ = threshold / kLeafsPerSplit;
            Octree tree = tree_;
            pruned = PruneOctree(tree, price_);
            if (IsFine(pruned) || threshold < kLeastThreshold)
                break;
            threshold /= kFiner;
        }
        return Coarsest(pruned);
    }
    /// Prunes further, for a lump that is `factor` times as large as it may be.
    Octree Shrink(double factor, PrunedOctree &pruned) {
        Octree tree = tree_;
        price_ *= float(factor * factor);
        pruned = PruneOctree(tree, price_);
        return tree;
    }

  private:
    /// Whether the tree is at least as fine as wanted.
    bool IsFine(const PrunedOctree &pruned) const {
        return options_.shBudget ? double(pruned.leafs) * kBytesPerLeaf >= *options_.shBudget
                                 : pruned.error <= double(options_.shErrorTarget);
    }
    /// The tree of the highest price that is still fine, or with a budget the first that fits.
    Octree Coarsest(PrunedOctree &pruned) {
        float low = price_, high = price_ * kMostPrice;
        for (int i = 0; i < kBisections; ++i) {
            const float middle = std::sqrt(low * high);
            Octree tree = tree_;
            (IsFine(PruneOctree(tree, middle)) ? low : high) = middle;
        }
        price_ = options_.shBudget && IsFine(pruned) ? high : low;
        Octree tree = tree_;
        pruned = PruneOctree(tree, price_);
        return tree;
    }

    const LightOptions &options_;
    Octree tree_;
    OctreeRefiner refiner_;
    float price_ = 0; ///< of a leaf of the last tree that was pruned
};

} // namespace

SparseGridSH BakeSparseGrid(const GridInputs &in, const std::vector<Light> &lights, const LightGridSH &uniform,
                            GridStats &work, SparseStats &result) {
    const SparseLattice lattice(uniform.header);
    const ProbeIntegrator integrator(in, lights);
    LatticeLight light(in, integrator, lattice);
    SparsePlan plan(in, lattice, light);
    PrunedOctree pruned;
    Octree tree = plan.Make(uniform, work, pruned);
    for (;;) {
        CornerWeights corners(tree, light);
        const std::vector<ShFloats> values = FitCorners(tree, light, corners, lattice, in.space);
        SparseGridSH grid = PackSparseGrid(MakeSparseTree(tree, light, corners, lattice, values));
        result = {pruned.leafs, grid.points.size(), EncodeSparseGrid(grid).size(), pruned.error};
        if (!in.options.shBudget || double(result.bytes) <= *in.options.shBudget || pruned.leafs == 0)
            return grid;
        const std::size_t before = pruned.leafs;
        tree = plan.Shrink(double(result.bytes) / *in.options.shBudget, pruned);
        if (pruned.leafs == before) // cells as large as they may be: the budget cannot be met
            return grid;
    }
}

} // namespace q3
