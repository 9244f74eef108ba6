// GPL-2.0-or-later. Nodes and values of the sparse grid in the file, from an octree.
#include "q3map2/light/sparse/sparse_tree.h"

#include "common/parallel.h"

#include <algorithm>
#include <bit>
#include <unordered_set>

namespace q3 {

namespace {

constexpr std::size_t kCornersOfJob = 1024;

/// What the file says of the lower corner of a leaf.
enum class CornerRecord : std::uint8_t { Nothing, Stored, Hanging, LeftOut };

/// Marks the lower corners of leafs, then writes the nodes breadth first. The lattice point at the lower corner of a
/// cell is the only one that the cell can record.
class TreeWriter {
  public:
    TreeWriter(Octree tree, const LatticePoints &points, const CornerWeights &corners, const JobPool &jobs)
        : tree_(std::move(tree)), points_(points), corners_(corners), recordOfLeaf_(tree_.Size()) {
        PlaceCorners(corners.Stored(), jobs);
        const std::vector<std::uint32_t> &unstored = corners.Unstored();
        PlaceCorners(unstored, jobs);
        std::vector<std::uint8_t> hasOtherParents(unstored.size()); // by corner: 1 if it hangs on other points
        ForAll(jobs, unstored.size(), kCornersOfJob, [&](std::size_t i) {
            hasOtherParents[i] = !corners.IsLeftOut(unstored[i]) &&
                                 !std::ranges::all_of(ParentsOf(points[unstored[i]].at),
                                                      [&](const LatticePoint &p) { return IsCorner(points.Find(p)); });
        });
        for (std::size_t i = 0; i < unstored.size(); ++i)
            if (hasOtherParents[i])
                PlaceParents(points[unstored[i]].at);
    }

    StoredTree Write(const JobPool &jobs) const;

  private:
    /// Of corners of open leafs.
    CornerRecord RecordOf(std::uint32_t number) const {
        if (corners_.IsStored(number))
            return CornerRecord::Stored;
        return corners_.IsLeftOut(number) ? CornerRecord::LeftOut : CornerRecord::Hanging;
    }
    /// Places corners of open leafs. Most are lower corners of leafs, which can be marked at the same time.
    void PlaceCorners(const std::vector<std::uint32_t> &numbers, const JobPool &jobs) {
        std::vector<std::uint8_t> isPlaced(numbers.size());
        ForAll(jobs, numbers.size(), kCornersOfJob, [&](std::size_t i) {
            const LatticePoint &p = points_[numbers[i]].at;
            const std::size_t leaf = tree_.LeafAt(p);
            isPlaced[i] = leaf != Octree::kNone && tree_[leaf].origin == p;
            if (isPlaced[i])
                recordOfLeaf_[leaf] = RecordOf(numbers[i]);
        });
        for (std::size_t i = 0; i < numbers.size(); ++i)
            if (!isPlaced[i])
                Place(points_[numbers[i]].at, RecordOf(numbers[i]));
    }
    /// Splits the leaf that contains p until p is its lower corner, and marks that. A leaf with open space is not
    /// split: p lies on its boundary, and a reader finds no corner there and goes on to the next larger cube around p.
    void Place(const LatticePoint &p, CornerRecord what) {
        std::size_t leaf = tree_.LeafAt(p);
        if (leaf == Octree::kNone)
            return;
        while (tree_[leaf].origin != p) {
            if (tree_[leaf].openFraction > 0)
                return;
            tree_.Split(leaf);
            recordOfLeaf_.resize(tree_.Size());
            std::swap(recordOfLeaf_[leaf],
                      recordOfLeaf_[tree_[leaf].child]); // the lower corner is now that of the first child
            leaf = tree_.LeafAt(p);
        }
        if (recordOfLeaf_[leaf] == CornerRecord::Nothing)
            recordOfLeaf_[leaf] = what;
    }
    /// Places those parents of a hanging point that are not corners of open leafs. They hang in turn, unless they are
    /// left out.
    void PlaceParents(const LatticePoint &p) {
        for (const LatticePoint &parent : ParentsOf(p)) {
            const std::uint32_t number = points_.Find(parent);
            if (IsCorner(number))
                continue;
            if (number != LatticePoints::kUnknown && corners_.IsLeftOut(number))
                Place(parent, CornerRecord::LeftOut);
            else if (others_.insert(KeyOf(parent)).second) {
                Place(parent, CornerRecord::Hanging);
                PlaceParents(parent);
            }
        }
    }
    bool IsCorner(std::uint32_t number) const { return number != LatticePoints::kUnknown && corners_.IsCorner(number); }
    /// By cell: whether it, or a leaf below it, owns a point.
    std::vector<bool> FindUsed() const;

    Octree tree_;
    const LatticePoints &points_;
    const CornerWeights &corners_;
    std::vector<CornerRecord> recordOfLeaf_;   ///< by cell; of leafs
    std::unordered_set<std::uint64_t> others_; ///< keys of the hanging points that are no corners of open leafs
};

std::vector<bool> TreeWriter::FindUsed() const {
    std::vector<bool> used(tree_.Size());
    for (std::size_t i = tree_.Size(); i-- > 0;) {
        if (tree_[i].child == 0)
            used[i] = recordOfLeaf_[i] != CornerRecord::Nothing;
        for (std::size_t c = 0; c < 8 && tree_[i].child != 0; ++c)
            used[i] = used[i] || used[tree_[i].child + c];
    }
    return used;
}

StoredTree TreeWriter::Write(const JobPool &jobs) const {
    StoredTree file;
    const std::vector<bool> used = FindUsed();
    std::vector<std::size_t> cellsOfLevel(tree_.RootCount()), nextLevel;
    for (std::size_t i = 0; i < cellsOfLevel.size(); ++i)
        cellsOfLevel[i] = i;
    std::vector<std::size_t> storedCells;
    for (; !cellsOfLevel.empty(); cellsOfLevel = std::move(nextLevel), nextLevel.clear())
        for (const std::size_t cell : cellsOfLevel) {
            SparseGridNode &node = file.nodes.emplace_back();
            for (std::size_t c = 0; c < 8 && tree_[cell].child != 0; ++c) {
                const std::size_t child = tree_[cell].child + c;
                const auto bit = std::uint8_t(1u << c);
                if (tree_[child].child != 0 && used[child]) {
                    node.inner |= bit;
                    nextLevel.push_back(child);
                } else if (used[child] && recordOfLeaf_[child] == CornerRecord::Hanging)
                    node.hanging |= bit;
                else if (used[child] && recordOfLeaf_[child] == CornerRecord::Stored) {
                    node.stored |= bit;
                    storedCells.push_back(child);
                }
            }
        }
    file.order.resize(storedCells.size());
    ForAll(jobs, storedCells.size(), kCornersOfJob,
           [&](std::size_t i) { file.order[i] = corners_.StoredIndex(points_.Find(tree_[storedCells[i]].origin)); });
    return file;
}

} // namespace

StoredTree StoreTree(Octree tree, const LatticePoints &points, const CornerWeights &corners, const JobPool &jobs) {
    return TreeWriter(std::move(tree), points, corners, jobs).Write(jobs);
}

SparseGridTree MakeSparseTree(StoredTree stored, const SparseLattice &lattice, const std::vector<SHFloats> &values,
                              const JobPool &jobs) {
    SparseGridTree file;
    file.nodes = std::move(stored.nodes);
    file.values = VectorInParallel<bspGridPointSH_t>(stored.order.size(), jobs);
    ForAll(jobs, file.values.size(), kCornersOfJob,
           [&](std::size_t i) { file.values[i] = std::bit_cast<bspGridPointSH_t>(values[stored.order[i]]); });
    const Vec3f &mins = lattice.Mins(), &cell = lattice.Cell();
    file.mins = {mins.x, mins.y, mins.z};
    file.cell = {cell.x, cell.y, cell.z};
    file.roots = lattice.Roots();
    file.levels = lattice.Levels();
    return file;
}

} // namespace q3
