// GPL-2.0-or-later. Stored and hanging corners of the cells of an octree.
#include "q3map2/light/sparse/corner_weights.h"

#include <algorithm>

namespace q3 {

CornerWeights::CornerWeights(const Octree &tree, const LatticePoints &light)
    : tree_(tree), light_(light), storedOf_(light.Size(), LatticePoints::kUnknown), terms_(light.Size()) {
    for (const std::size_t leaf : tree.OpenLeafs())
        for (std::size_t c = 0; c < 8; ++c)
            TermsOf(tree[leaf].Corner(c));
}

std::size_t CornerWeights::HangsOn(const LatticePoint &p) const {
    std::size_t largest = Octree::kNone;
    for (const std::size_t leaf : tree_.LeafsAround(p))
        if (leaf != Octree::kNone && tree_[leaf].open > 0 && !tree_[leaf].HasCorner(p) &&
            (largest == Octree::kNone || tree_[leaf].level > tree_[largest].level))
            largest = leaf;
    return largest;
}

const std::vector<CornerTerm> &CornerWeights::TermsOf(const LatticePoint &corner) {
    const std::uint32_t number = light_.Find(corner);
    if (!terms_[number].empty())
        return terms_[number];
    const std::size_t leaf = HangsOn(corner);
    if (leaf != Octree::kNone)
        return terms_[number] = TermsIn(tree_[leaf], corner);
    storedOf_[number] = std::uint32_t(stored_.size());
    stored_.push_back(number);
    return terms_[number] = {{storedOf_[number], 1.0f}};
}

std::vector<CornerTerm> CornerWeights::TermsIn(const OctreeCell &leaf, const Vec3f &at) {
    std::vector<CornerTerm> all;
    for (std::size_t c = 0; c < 8; ++c) {
        const float weight = leaf.Weight(c, at);
        if (weight == 0)
            continue;
        for (const CornerTerm &term : TermsOf(leaf.Corner(c))) {
            const auto same =
                std::find_if(all.begin(), all.end(), [&](const CornerTerm &t) { return t.stored == term.stored; });
            if (same == all.end())
                all.push_back({term.stored, weight * term.weight});
            else
                same->weight += weight * term.weight;
        }
    }
    return all;
}

} // namespace q3
