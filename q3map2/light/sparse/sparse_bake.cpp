// GPL-2.0-or-later. The sparse SH grid.
#include "q3map2/light/sparse/sparse_bake.h"

#include "q3map2/light/sparse/corner_fit.h"
#include "q3map2/light/sparse/octree_prune.h"
#include "q3map2/light/sparse/octree_refine.h"
#include "q3map2/light/sparse/sparse_tree.h"

#include <cmath>

namespace q3 {

SparseGridSH BakeSparseGrid(const GridInputs &in, const std::vector<Light> &lights, const LightGridSH &uniform,
                            GridStats &work, SparseStats &result) {
    const SparseLattice lattice(uniform.header);
    const ProbeIntegrator integrator(in, lights);
    LatticeLight light(in, integrator, lattice);
    Octree tree(lattice);
    OctreeRefiner refiner(in, lattice, tree, light);
    refiner.Start(uniform);
    const float price = float(std::getenv("SG_LAMBDA") ? std::atof(std::getenv("SG_LAMBDA")) : 3000);
    refiner.Refine(price, work);
    const PrunedOctree pruned = PruneOctree(tree, price);
    CornerWeights corners(tree, light);
    const std::vector<ShFloats> values = FitCorners(tree, light, corners, lattice, in.space);
    SparseGridSH grid = PackSparseGrid(MakeSparseTree(tree, light, corners, lattice, values));
    result = {pruned.leafs, grid.points.size(), EncodeSparseGrid(grid).size(), pruned.error};
    std::fprintf(stderr, "RESULT leafs %zu stored %zu nodes %zu MB %.2f error %.3f\n", result.leafs, result.stored,
                 grid.nodes.size(), double(result.bytes) / 1e6, result.error);
    return grid;
}

} // namespace q3
