// GPL-2.0-or-later. The octree of the sparse SH grid while it is built, and its optimal pruning.
#pragma once

#include "common/parallel.h"
#include "q3map2/light/sparse/lattice.h"

#include <cmath>
#include <limits>
#include <vector>

namespace q3 {

/// A cell of the octree: a leaf, or an inner node with eight children.
struct OctreeCell {
    LatticePoint origin{};    ///< lower corner
    std::int32_t level = 0;   ///< its edge is 2^level smallest cells
    std::uint32_t child = 0;  ///< index of the first child; child c is the octant of corner c. 0: leaf
    float openFraction = 0;   ///< open fraction of its volume, estimated from its corners; 0: no open space at all
    float error = 0;          ///< expected mean squared error of interpolation between its corners, displayed, bytes^2
    float nearLightError = 0; ///< the same, measured by NearLightSet at its samples; 0: it has none inside

    std::int32_t Edge() const { return std::int32_t(1) << level; }
    /// Open volume in smallest cells.
    float Volume() const { return openFraction * float(std::int64_t(1) << (3 * level)); }
    /// Corner c: bit 0 of c is set for the upper corners in x, bit 1 in y, bit 2 in z.
    LatticePoint Corner(std::size_t c) const {
        return {origin[0] + (c & 1 ? Edge() : 0), origin[1] + (c & 2 ? Edge() : 0), origin[2] + (c & 4 ? Edge() : 0)};
    }
    /// Whether a point of the closed cell is one of its corners.
    bool HasCorner(const LatticePoint &p) const { return ((p[0] | p[1] | p[2]) & (Edge() - 1)) == 0; }
    /// Trilinear weight of corner c at a position in lattice units.
    float Weight(std::size_t c, const Vec3f &at) const {
        float weight = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const float part = (at[axis] - float(origin[axis])) / float(Edge());
            weight *= c >> axis & 1 ? part : 1 - part;
        }
        return weight;
    }
};

/// A lattice point as a position in lattice units.
inline Vec3f LatticePosition(const LatticePoint &p) {
    return {float(p[0]), float(p[1]), float(p[2])};
}

/// The smallest cell that contains a position in lattice units.
inline LatticePoint CellAt(const Vec3f &at) {
    return {std::int32_t(std::floor(at.x)), std::int32_t(std::floor(at.y)), std::int32_t(std::floor(at.z))};
}

/// A box of root cubes, each divided into an octree. Cells are named by their index, which only
/// DropUnused changes.
class Octree {
  public:
    static constexpr std::size_t kNone = std::size_t(-1);
    explicit Octree(const SparseLattice &lattice);
    /// Becomes a copy of an octree over the same lattice that has no fewer cells, which all workers make.
    void CopyFrom(const Octree &other, const JobPool &jobs);
    /// Frees the cells below leafs, which PruneOctree leaves there. The others get new indexes.
    void DropUnused();
    /// Gives a leaf eight children, which inherit its openFraction.
    void Split(std::size_t leaf);
    /// The same for several leafs, in order.
    void Split(std::span<const std::size_t> leafs, const JobPool &jobs);
    /// The root that contains a position in lattice units; kNone outside the roots.
    std::size_t RootAt(const Vec3f &at) const;
    /// The leaf that contains a point (cells are half-open: lower faces belong to them); kNone outside the roots.
    std::size_t LeafAt(const LatticePoint &p) const;
    /// The leafs whose closure contains a point: bit 0 of the index is set for the lower side of the point in x, bit 1
    /// in y, bit 2 in z. kNone outside the roots; a leaf may occur more than once.
    std::array<std::size_t, 8> LeafsAround(const LatticePoint &p) const;
    /// All leafs that have open space, depth first.
    std::vector<std::size_t> OpenLeafs() const;
    OctreeCell &operator[](std::size_t i) { return cells_[i]; }
    const OctreeCell &operator[](std::size_t i) const { return cells_[i]; }
    std::size_t Size() const { return cells_.Size(); }
    std::size_t RootCount() const { return rootCount_; }

  private:
    /// Makes a leaf the parent of eight cells from index `child` on.
    void MakeChildren(std::size_t leaf, std::size_t child);

    Int3 roots_;
    int levels_;
    std::size_t rootCount_;
    ChunkedVector<OctreeCell> cells_; ///< the roots first, x fastest; parents before their children
};

/// Size and expected error of an octree that PruneOctree has pruned.
struct PruningStats {
    std::size_t leafs = 0; ///< with open space; about the number of stored points
    double volume = 0;     ///< open volume in smallest cells
    double error = 0;      ///< expected displayed error over the open volume: RMS, bytes
};

/// Turns inner nodes, except roots, into leafs so that the sum over all leafs of (squared error x open volume + price)
/// is least: the pruning of Breiman et al. (1984) and of Chou, Lookabaugh and Gray (1989). price: the Lagrange
/// multiplier of the number of leafs, bytes^2 times smallest cells. maxNearLightError: inner nodes with a larger
/// OctreeCell::nearLightError stay inner nodes. Sets openFraction of inner nodes from their children.
PruningStats PruneOctree(Octree &tree, float price, float maxNearLightError = std::numeric_limits<float>::infinity(),
                         const JobPool &jobs = JobPool(1));

} // namespace q3
