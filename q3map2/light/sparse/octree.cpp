// GPL-2.0-or-later. The octree of the sparse SH grid while it is built, and its optimal pruning.
#include "q3map2/light/sparse/octree.h"

#include "common/parallel.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace q3 {

// ---- The octree ----

Octree::Octree(const SparseLattice &lattice) : roots_(lattice.Roots()), levels_(lattice.Levels()) {
    const std::int32_t edge = std::int32_t(1) << levels_;
    for (std::int32_t z = 0; z < roots_[2]; ++z)
        for (std::int32_t y = 0; y < roots_[1]; ++y)
            for (std::int32_t x = 0; x < roots_[0]; ++x)
                cells_.Add({.origin = {x * edge, y * edge, z * edge}, .level = levels_});
    rootCount_ = cells_.Size();
}

void Octree::CopyFrom(const Octree &other, const JobPool &jobs) {
    constexpr std::size_t kCopiedCells = 16384;
    cells_.Grow(other.Size(), jobs);
    ForAll(jobs, Size(), kCopiedCells, [&](std::size_t i) { cells_[i] = other.cells_[i]; });
}

void Octree::DropUnused() {
    const ChunkedVector<OctreeCell> all = std::exchange(cells_, {});
    for (std::size_t root = 0; root < rootCount_; ++root)
        cells_.Add(all[root]);
    for (std::size_t i = 0; i < Size(); ++i)
        if (const std::size_t child = cells_[i].child; child != 0) {
            cells_[i].child = std::uint32_t(Size());
            for (std::size_t c = 0; c < 8; ++c)
                cells_.Add(all[child + c]);
        }
}

void Octree::MakeChildren(std::size_t leaf, std::size_t child) {
    OctreeCell half = cells_[leaf];
    --half.level;
    for (std::size_t c = 0; c < 8; ++c)
        cells_[child + c] = {.origin = half.Corner(c), .level = half.level, .openFraction = half.openFraction};
    cells_[leaf].child = std::uint32_t(child);
}

void Octree::Split(std::size_t leaf) {
    const std::size_t child = cells_.Size();
    for (std::size_t c = 0; c < 8; ++c)
        cells_.Add({});
    MakeChildren(leaf, child);
}

void Octree::Split(std::span<const std::size_t> leafs, const JobPool &jobs) {
    constexpr std::size_t kLeafsOfJob = 256;
    const std::size_t firstChild = cells_.Size();
    cells_.Grow(firstChild + 8 * leafs.size(), jobs);
    ForAll(jobs, leafs.size(), kLeafsOfJob, [&](std::size_t i) { MakeChildren(leafs[i], firstChild + 8 * i); });
}

std::size_t Octree::RootAt(const Vec3f &at) const {
    std::size_t number = 0, stride = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float root = std::floor(at[axis] / float(std::int32_t(1) << levels_));
        if (!(root >= 0 && root < float(roots_[axis])))
            return kNone;
        number += stride * std::size_t(root);
        stride *= std::size_t(roots_[axis]);
    }
    return number;
}

std::size_t Octree::LeafAt(const LatticePoint &p) const {
    std::size_t cell = 0, stride = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int32_t root = p[axis] >> levels_;
        if (p[axis] < 0 || root >= roots_[axis])
            return kNone;
        cell += stride * std::size_t(root);
        stride *= std::size_t(roots_[axis]);
    }
    while (cells_[cell].child != 0) {
        const int bit = cells_[cell].level - 1; // of the coordinates: set in the upper half of the cell
        cell = cells_[cell].child + std::size_t((p[0] >> bit & 1) | (p[1] >> bit & 1) << 1 | (p[2] >> bit & 1) << 2);
    }
    return cell;
}

std::array<std::size_t, 8> Octree::LeafsAround(const LatticePoint &p) const {
    std::array<std::size_t, 8> leafs{};
    for (int octant = 0; octant < 8; ++octant)
        leafs[std::size_t(octant)] = LeafAt({p[0] - (octant & 1), p[1] - (octant >> 1 & 1), p[2] - (octant >> 2 & 1)});
    return leafs;
}

std::vector<std::size_t> Octree::OpenLeafs() const {
    std::vector<std::size_t> leafs, stack;
    for (std::size_t root = rootCount_; root-- > 0;)
        stack.push_back(root);
    while (!stack.empty()) {
        const std::size_t cell = stack.back();
        stack.pop_back();
        if (cells_[cell].child != 0)
            for (std::size_t c = 8; c-- > 0;)
                stack.push_back(cells_[cell].child + c);
        else if (cells_[cell].openFraction > 0)
            leafs.push_back(cell);
    }
    return leafs;
}

// ---- Optimal pruning ----

namespace {

/// What PruneOctree does below a root.
class RootPruning {
  public:
    RootPruning(Octree &tree, float price, float maxNearLightError)
        : tree_(tree), price_(price), maxNearLightError_(maxNearLightError) {}

    struct Result {
        float cost = 0;    ///< the least sum over the leafs below a cell, or as a leaf
        bool kept = false; ///< lights nearby keep it from being pruned, or a cell below it
    };
    Result Prune(std::size_t i) {
        OctreeCell &cell = tree_[i];
        const std::size_t firstLeaf = leafs_.size();
        Result below;
        float open = 0; // the corners of a large cell say little about how open it is
        for (std::size_t c = 0; c < 8 && cell.child != 0; ++c) {
            const Result ofChild = Prune(cell.child + c);
            below.cost += ofChild.cost;
            below.kept = below.kept || ofChild.kept;
            open += tree_[cell.child + c].openFraction / 8;
        }
        if (cell.openFraction <= 0)
            return {};
        if (cell.child != 0) {
            cell.openFraction = open;
            below.kept = below.kept || cell.nearLightError > maxNearLightError_;
        }
        const float asLeaf = cell.error * cell.Volume() + price_;
        if (cell.child != 0 && (i < tree_.RootCount() || !(asLeaf <= below.cost) || below.kept))
            return below;
        cell.child = 0;
        leafs_.resize(firstLeaf);
        if (cell.openFraction > 0)
            leafs_.push_back({cell.error, cell.Volume()});
        return {asLeaf, false};
    }

    struct Leaf {
        float error, volume;
    };
    const std::vector<Leaf> &Leafs() const { return leafs_; }

  private:
    Octree &tree_;
    float price_, maxNearLightError_;
    std::vector<Leaf> leafs_; ///< those with open space, depth first
};

} // namespace

PruningStats PruneOctree(Octree &tree, float price, float maxNearLightError, const JobPool &jobs) {
    std::vector<RootPruning> roots(tree.RootCount(), {tree, price, maxNearLightError});
    jobs.For(std::int64_t(roots.size()), [&](std::int64_t i, int) { roots[std::size_t(i)].Prune(std::size_t(i)); });
    PruningStats result;
    double error = 0;
    for (const RootPruning &root : roots)
        for (const auto &[leafError, leafVolume] : root.Leafs()) {
            error += double(leafError) * double(leafVolume);
            result.volume += double(leafVolume);
            ++result.leafs;
        }
    result.error = result.volume > 0 ? std::sqrt(error / result.volume) : 0;
    return result;
}

} // namespace q3
