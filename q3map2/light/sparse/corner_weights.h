// GPL-2.0-or-later. Which corners of cells store a value, and how the others follow from them.
#pragma once

#include "q3map2/light/sparse/lattice_points.h"
#include "q3map2/light/sparse/octree.h"

#include <span>
#include <vector>

namespace q3 {

/// A stored value and its weight.
struct CornerTerm {
    std::uint32_t stored = 0;
    float weight = 0;
};

/// The corners of the open leafs of a tree. A corner that lies on the boundary of a larger open leaf, but is not a
/// corner of it, is *hanging*: it has the value that the larger leaf gives there, so that light is continuous. All
/// other corners are stored. Keeps references.
class CornerWeights {
  public:
    CornerWeights(const Octree &tree, const LatticePoints &light);
    /// Numbers of the stored points, in the order of CornerTerm::stored.
    const std::vector<std::uint32_t> &Stored() const { return stored_; }
    bool IsStored(std::uint32_t point) const { return storedOf_[point] != LatticePoints::kUnknown; }
    /// Value of a known point in a closed leaf, as terms.
    std::vector<CornerTerm> TermsIn(const OctreeCell &leaf, const LatticePoint &p);
    /// The largest open leaf that p hangs on, or Octree::kNone.
    std::size_t HangsOn(const LatticePoint &p) const;

  private:
    const std::vector<CornerTerm> &TermsOf(const LatticePoint &corner);

    const Octree &tree_;
    const LatticePoints &light_;
    std::vector<std::uint32_t> stored_, storedOf_;
    std::vector<std::vector<CornerTerm>> terms_; ///< by point; empty: not yet known
};

} // namespace q3
