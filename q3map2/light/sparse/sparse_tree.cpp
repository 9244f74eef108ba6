// GPL-2.0-or-later. Converts the octree to the nodes and values of the sparse SH grid.
#include "q3map2/light/sparse/sparse_tree.h"

#include <algorithm>
#include <bit>
#include <unordered_set>

namespace q3 {

namespace {

/// What the file says of the lower corner of a leaf.
enum class Owned : std::uint8_t { Nothing, Stored, Hanging };

/// Marks the lower corners of leafs, then writes the nodes breadth first.
class TreeWriter {
  public:
    TreeWriter(Octree tree, const LatticePoints &light, const CornerWeights &corners)
        : tree_(std::move(tree)), light_(light), corners_(corners) {
        for (const std::uint32_t number : corners.Stored())
            Place(light[number].at, Owned::Stored);
        for (const std::size_t leaf : tree_.OpenLeafs())
            for (std::size_t c = 0; c < 8; ++c)
                if (const LatticePoint p = tree_[leaf].Corner(c); !corners.IsStored(light.Find(p)))
                    PlaceHanging(p);
    }

    SparseGridTree Write(const std::vector<ShFloats> &values) const;

  private:
    /// Marks p, and splits the leaf that contains it until p is its lower corner. A leaf with open space is not split:
    /// p lies on its boundary, and readers go on to the cube around by themselves.
    void Place(const LatticePoint &p, Owned what) {
        std::size_t leaf = tree_.LeafAt(p);
        if (leaf == Octree::kNone)
            return;
        while (tree_[leaf].origin != p) {
            if (tree_[leaf].open > 0)
                return;
            tree_.Split(leaf);
            owned_.resize(tree_.Size(), Owned::Nothing);
            std::swap(owned_[leaf], owned_[tree_[leaf].child]); // the lower corner is now that of the first child
            leaf = tree_.LeafAt(p);
        }
        owned_.resize(tree_.Size(), Owned::Nothing);
        if (owned_[leaf] == Owned::Nothing)
            owned_[leaf] = what;
    }
    /// Places a hanging point and its parents, between which readers interpolate it: with 2^power the greatest power of
    /// two that divides all its coordinates, the points 2^power away on both sides of each axis on which its coordinate
    /// is an odd multiple of that.
    void PlaceHanging(const LatticePoint &p) {
        if (!hanging_.insert(KeyOf(p)).second)
            return;
        Place(p, Owned::Hanging);
        const int power = std::countr_zero(std::uint32_t(p[0] | p[1] | p[2]));
        std::vector<LatticePoint> parents{p};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if ((p[axis] >> power & 1) == 0)
                continue;
            const std::size_t count = parents.size();
            for (std::size_t i = 0; i < count; ++i) {
                parents.push_back(parents[i]);
                parents[i][axis] -= 1 << power;
                parents.back()[axis] += 1 << power;
            }
        }
        for (const LatticePoint &parent : parents) {
            const std::uint32_t number = light_.Find(parent);
            if (number == LatticePoints::kUnknown || !corners_.IsStored(number))
                PlaceHanging(parent);
        }
    }
    /// By cell: whether it, or a leaf below it, owns a point.
    std::vector<bool> FindUsed() const;

    Octree tree_;
    const LatticePoints &light_;
    const CornerWeights &corners_;
    std::vector<Owned> owned_;                  ///< by leaf; may be shorter than the tree
    std::unordered_set<std::uint64_t> hanging_; ///< keys of the hanging points that are placed
};

std::vector<bool> TreeWriter::FindUsed() const {
    std::vector<bool> used(tree_.Size());
    for (std::size_t i = tree_.Size(); i-- > 0;) {
        if (tree_[i].child == 0)
            used[i] = i < owned_.size() && owned_[i] != Owned::Nothing;
        for (std::size_t c = 0; c < 8 && tree_[i].child != 0; ++c)
            used[i] = used[i] || used[tree_[i].child + c];
    }
    return used;
}

SparseGridTree TreeWriter::Write(const std::vector<ShFloats> &values) const {
    SparseGridTree file;
    const std::vector<bool> used = FindUsed();
    std::vector<std::size_t> level(tree_.RootCount()), next;
    for (std::size_t i = 0; i < level.size(); ++i)
        level[i] = i;
    std::vector<std::uint32_t> valueOf(light_.Size());
    for (std::size_t i = 0; i < values.size(); ++i)
        valueOf[corners_.Stored()[i]] = std::uint32_t(i);
    for (; !level.empty(); level = std::move(next), next.clear())
        for (const std::size_t at : level) {
            SparseGridNode &node = file.nodes.emplace_back();
            for (std::size_t c = 0; c < 8 && tree_[at].child != 0; ++c) {
                const std::size_t child = tree_[at].child + c;
                const auto bit = std::uint8_t(1u << c);
                if (tree_[child].child != 0 && used[child]) {
                    node.inner |= bit;
                    next.push_back(child);
                } else if (used[child] && owned_[child] == Owned::Hanging)
                    node.hanging |= bit;
                else if (used[child]) {
                    node.stored |= bit;
                    file.values.push_back(
                        std::bit_cast<bspGridPointSH_t>(values[valueOf[light_.Find(tree_[child].origin)]]));
                }
            }
        }
    return file;
}

} // namespace

SparseGridTree MakeSparseTree(Octree tree, const LatticePoints &light, const CornerWeights &corners,
                              const SparseLattice &lattice, const std::vector<ShFloats> &values) {
    SparseGridTree file = TreeWriter(std::move(tree), light, corners).Write(values);
    const Vec3f &mins = lattice.Mins(), &cell = lattice.Cell();
    file.mins = {mins.x, mins.y, mins.z};
    file.cell = {cell.x, cell.y, cell.z};
    file.roots = lattice.Roots();
    file.levels = lattice.Levels();
    return file;
}

} // namespace q3
