// GPL-2.0-or-later. Portals in compact form, and the first passes over them: flood, symmetry.
#pragma once

#include "q3map2/vis/portal_graph.h"
#include "q3map2/vis/sparse_bits.h"
#include "q3map2/vis/vis.h"

#include <span>
#include <vector>

namespace q3 {

class VisUnits;

/// A directed portal in the form that the passes read: small and contiguous in memory.
struct alignas(16) FlowPortal {
    VisPlane plane; ///< normal into `leaf`
    Vec3f center;
    float radius = 0;
    WindingView winding;
    int leaf = 0;             ///< leaf to which the portal leads
    std::uint32_t column = 0; ///< its bit in rows of the tables
    bool sky = false, removed = false;
    bool hasTwin = false; ///< portal ^ 1 has the same winding and the opposite direction
};

/// An axial box: center, and half of its size.
struct PortalBounds {
    Vec3f center, extent;
};
/// How far a box reaches from its center along the normal of a plane.
inline float Reach(const PortalBounds &box, const VisPlane &plane) {
    const Vec3f &n = plane.normal;
    return std::abs(n.x) * box.extent.x + std::abs(n.y) * box.extent.y + std::abs(n.z) * box.extent.z;
}

/// The portal graph, read only.
class VisMap {
  public:
    /// Portals out of a leaf are in descending order of radius with `widestFirst`, else in file order.
    VisMap(const PortalGraph &graph, bool widestFirst);
    VisMap(const VisMap &) = delete;
    VisMap &operator=(const VisMap &) = delete;

    std::size_t NumLeafs() const { return leafFirst_.size() - 1; }
    std::size_t NumPortals() const { return portals_.size(); }
    const FlowPortal &Portal(std::size_t index) const { return portals_[index]; }
    /// Portals that lead out of a leaf; removed ones are left out.
    std::span<const int> PortalsOf(int leaf) const {
        const auto first = std::size_t(leafFirst_[std::size_t(leaf)]);
        return {leafPortals_.data() + first, std::size_t(leafFirst_[std::size_t(leaf) + 1]) - first};
    }
    /// Portals that lead out of the leaf behind a portal: the candidates for the next portal of a chain.
    std::span<const int> PortalsAfter(std::size_t portal) const { return PortalsOf(portals_[portal].leaf); }
    // Columns: bits of rows. Portals of about the same direction are next to each other, since what is seen through a
    // portal faces one way: so most words have many bits or none.

    /// Number of bits of a row: a multiple of that of a block.
    std::size_t Columns() const { return portalAt_.size(); }
    std::size_t Words() const { return WordsOf(Columns()); }
    std::size_t Column(std::size_t portal) const { return portals_[portal].column; }
    bool HasPortal(std::size_t column) const { return portalAt_[column] >= 0; }
    /// The portal of a column that has one.
    std::size_t PortalAt(std::size_t column) const { return std::size_t(portalAt_[column]); }
    /// The word that holds, at the same bits, the twins of the portals of a word.
    std::size_t TwinWord(std::size_t word) const { return twinWord_[word]; }
    /// Bounds of the portals of a word.
    const PortalBounds &BoundsOfWord(std::size_t word) const { return bounds_[word]; }

  private:
    void SetColumns();

    std::vector<FlowPortal> portals_;
    std::vector<int> portalAt_; ///< by column; -1: none
    std::vector<std::size_t> twinWord_;
    std::vector<int> leafFirst_, leafPortals_;
    std::vector<float> points_;
    std::vector<PortalBounds> bounds_; ///< by word
};

/// Bit VisMap::Column(q) of row p: portal q may be seen through portal p. Passes only clear bits.
using MightSeeTable = SparseBitTable;

/// The first estimate: q may be seen through p if part of q is in front of p, part of p is behind q, both are within
/// the far plane, and a chain of such portals leads from p to q.
/// units: rows that are known are not computed; a part of the first round computes its own, and those that its passages
/// need.
MightSeeTable FloodMightSee(const VisMap &map, const FarPlane &farPlane, const VisUnits &units, const JobPool &jobs,
                            Log &log);

/// Visibility is symmetric: clears bit q of row p if bit p ^ 1 of row q ^ 1 is clear, for portals that have twins.
void ApplySymmetry(const VisMap &map, const JobPool &jobs, MightSeeTable &mightSee);

/// Portals in ascending order of the number of bits of their rows, ties by index; all by index unless `sorted`.
std::vector<int> OrderPortals(const VisMap &map, const MightSeeTable &mightSee, bool sorted);

/// The portals that a part of the first round computes, by portal: those next to each other in the file, which are
/// neighbors in the map.
std::vector<std::uint8_t> OwnPortals(const VisMap &map, const VisUnits &units);

} // namespace q3
