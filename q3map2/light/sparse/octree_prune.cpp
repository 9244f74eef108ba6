// GPL-2.0-or-later. Optimal pruning of the octree.
#include "q3map2/light/sparse/octree_prune.h"

#include <algorithm>
#include <cmath>

namespace q3 {

PrunedOctree PruneOctree(Octree &tree, float price, float maxLamp) {
    std::vector<float> cost(tree.Size());
    std::vector<bool> kept(tree.Size());          // nodes that are not pruned, for lamps, and those above them
    for (std::size_t i = tree.Size(); i-- > 0;) { // children come after their parents
        OctreeCell &cell = tree[i];
        if (cell.open <= 0)
            continue;
        if (cell.child != 0) { // the corners of a large cell say little about how open it is
            cell.open = 0;
            for (std::size_t c = 0; c < 8; ++c)
                cell.open += tree[cell.child + c].open / 8;
        }
        const float asLeaf = cell.error * cell.Volume() + price;
        float asParent = 0;
        kept[i] = cell.child != 0 && cell.lamp > maxLamp;
        for (std::size_t c = 0; c < 8 && cell.child != 0; ++c) {
            asParent += cost[cell.child + c];
            kept[i] = kept[i] || kept[cell.child + c];
        }
        const bool prune = cell.child != 0 && i >= tree.RootCount() && asLeaf <= asParent && !kept[i];
        if (prune)
            cell.child = 0;
        cost[i] = cell.child == 0 ? asLeaf : asParent;
    }
    PrunedOctree result;
    double error = 0;
    for (const std::size_t leaf : tree.OpenLeafs()) {
        error += double(tree[leaf].error) * double(tree[leaf].Volume());
        result.volume += double(tree[leaf].Volume());
        ++result.leafs;
    }
    result.error = result.volume > 0 ? std::sqrt(error / result.volume) : 0;
    return result;
}

} // namespace q3
