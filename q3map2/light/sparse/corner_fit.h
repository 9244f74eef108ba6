// GPL-2.0-or-later. Corners of the cells of an octree: which are stored, and their fit to the light inside the cells.
#pragma once

#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/sparse/lattice.h"
#include "q3map2/light/sparse/least_squares.h"
#include "q3map2/light/sparse/octree.h"

#include <span>
#include <vector>

namespace q3 {

/// A term of a linear combination of stored values.
struct CornerTerm {
    std::uint32_t stored = 0; ///< index in CornerWeights::Stored
    float weight = 0;
};

/// The points between which readers interpolate a hanging point. With 2^power the greatest power of two that divides
/// all three coordinates, they are p +- 2^power along each axis on which the coordinate is an odd multiple of 2^power:
/// 2 to 8 points of equal weight.
std::vector<LatticePoint> ParentsOf(const LatticePoint &p);

/// The largest open leaf that has p on its boundary, but not as a corner; Octree::kNone: p does not hang.
std::size_t LeafHungOn(const Octree &tree, const LatticePoint &p);

/// The corners of the open leafs of a tree. A corner that lies on the boundary of a larger open leaf, but is not a
/// corner of it, is *hanging*: its value is interpolated in the larger leaf, so that light is continuous. All other
/// corners are stored. Keeps references.
///
/// A caller may choose otherwise, by point. Where a corner is left out it has no value, and readers make the weights of
/// the others add up to 1. Where one is stored although it could hang, light jumps between the leafs.
class CornerWeights {
  public:
    enum class Rule : std::uint8_t { HangOrStore, Store, LeaveOut };
    /// rules: by point; empty: HangOrStore for all.
    CornerWeights(const Octree &tree, const LatticePoints &points, std::vector<Rule> rules = {},
                  const JobPool &jobs = JobPool(1));
    /// Numbers, in LatticePoints, of the stored points.
    const std::vector<std::uint32_t> &Stored() const { return stored_; }
    /// Numbers of the corners that hang or are left out.
    const std::vector<std::uint32_t> &Unstored() const { return unstored_; }
    /// Whether a point is a corner of an open leaf.
    bool IsCorner(std::uint32_t point) const {
        return IsStored(point) || unstoredOf_[point] != LatticePoints::kUnknown;
    }
    bool IsStored(std::uint32_t point) const { return storedOf_[point] != LatticePoints::kUnknown; }
    /// Index in Stored of a stored point.
    std::uint32_t StoredIndex(std::uint32_t point) const { return storedOf_[point]; }
    bool IsLeftOut(std::uint32_t point) const { return !rules_.empty() && rules_[point] == Rule::LeaveOut; }
    /// The interpolated value at a point inside or on the boundary of an open leaf, as a combination of stored values.
    /// Where corners are left out, the weights add up to less than 1.
    std::vector<CornerTerm> TermsIn(const OctreeCell &leaf, const LatticePoint &p) const {
        return TermsIn(leaf, LatticePosition(p));
    }
    std::vector<CornerTerm> TermsIn(const OctreeCell &leaf, const Vec3f &at) const;

  private:
    void FindTerms(const std::vector<std::size_t> &hungOn, const JobPool &jobs);
    void NumberStored(const std::vector<std::uint32_t> &corners, const JobPool &jobs);
    void AddCorner(float weight, std::uint32_t number, std::vector<CornerTerm> &sum) const;
    std::vector<CornerTerm> TermsOfParents(const LatticePoint &p) const;
    static void AddTerms(float weight, std::span<const CornerTerm> terms, std::vector<CornerTerm> &sum);

    const Octree &tree_;
    const LatticePoints &points_;
    std::vector<Rule> rules_; ///< by point; may be empty
    std::vector<std::uint32_t> stored_, unstored_;
    std::vector<std::uint32_t> storedOf_, unstoredOf_; ///< by point: index in stored_ or unstored_, or kUnknown
    std::vector<std::vector<CornerTerm>> terms_;       ///< by index in unstored_: of hanging corners
};

/// Number of corners that CornerWeights stores without rules.
std::size_t CountStoredCorners(const Octree &tree, const LatticePoints &points, const JobPool &jobs);

/// What stored corners are fitted to.
struct CornerSamples {
    std::vector<std::uint32_t> stored; ///< CornerWeights::Stored
    std::vector<SampleBlock> blocks;   ///< the light at points and near lights, numbered in this order
};
/// All points of `points` in the open, and `nearLights`. Points of cells that touch solids count only where they are
/// stored corners, so that no light is fitted through a wall.
CornerSamples SampleCorners(const Octree &tree, const LatticePoints &points, const CornerWeights &corners,
                            const SparseLattice &lattice, const BspSpace &space,
                            std::span<const NearLightSample> nearLights = {}, const JobPool &jobs = JobPool(1));

/// Least-squares values of the stored corners, in their order. Minimizes the sum over the samples s of
/// w(s) |interpolated(s) - light(s)|^2, plus for each corner a pull towards its own light, by conjugate gradients.
/// w: FitWeight. points, nearLights: those of the samples.
std::vector<SHFloats> FitCorners(CornerSamples samples, const LatticePoints &points,
                                 std::span<const NearLightSample> nearLights = {}, const JobPool &jobs = JobPool(1));

} // namespace q3
