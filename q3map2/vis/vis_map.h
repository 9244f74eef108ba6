// GPL-2.0-or-later. Portals in compact form, and the passes over them: flood, passages, symmetry.
#pragma once

#include "libs/math/bit_table.h"
#include "q3map2/vis/portal_graph.h"
#include "q3map2/vis/vis.h"

#include <memory>
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
    int leaf = 0; ///< leaf to which the portal leads
    bool sky = false, removed = false;
    bool hasTwin = false; ///< portal ^ 1 has the same winding and the opposite direction
};

/// The portal graph, read only.
class VisMap {
  public:
    /// Portals out of a leaf are in descending order of radius with `widestFirst`, else in file order.
    VisMap(const PortalGraph &graph, bool widestFirst);
    VisMap(const VisMap &) = delete;
    VisMap &operator=(const VisMap &) = delete;

    std::size_t NumPortals() const { return portals_.size(); }
    const FlowPortal &Portal(std::size_t index) const { return portals_[index]; }
    /// Portals that lead out of a leaf; removed ones are left out.
    std::span<const int> PortalsOf(int leaf) const {
        const auto first = std::size_t(leafFirst_[std::size_t(leaf)]);
        return {leafPortals_.data() + first, std::size_t(leafFirst_[std::size_t(leaf) + 1]) - first};
    }
    /// Portals that lead out of the leaf behind a portal: the candidates for the next portal of a chain.
    std::span<const int> PortalsAfter(std::size_t portal) const { return PortalsOf(portals_[portal].leaf); }

  private:
    std::vector<FlowPortal> portals_;
    std::vector<int> leafFirst_, leafPortals_;
    std::vector<float> points_;
};

/// Bit q of row p: portal q may be seen through portal p. Passes only clear bits.
using MightSeeTable = BitTable;

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

/// For each pair of successive portals of a chain: the portals that may be seen through both.
class Passages {
  public:
    /// Memory of the table in bytes.
    static std::uint64_t BytesFor(const VisMap &map);
    /// units: as in FloodMightSee.
    Passages(const VisMap &map, const MightSeeTable &mightSee, const VisUnits &units, const JobPool &jobs, Log &log);
    /// The rows have no values yet.
    explicit Passages(const VisMap &map);

    /// Portals seen through `first` and then through VisMap::PortalsAfter(first)[next].
    const BitWord *Row(std::size_t first, std::size_t next) const { return &table_[(start_[first] + next) * words_]; }
    /// All rows, one after another.
    std::span<BitWord> All() { return {table_.get(), rows_ * words_}; }

    /// Restricts each row p to the union over next portals t of t itself and of passage(p, t) & row t, in several
    /// rounds, since a smaller row can shrink others.
    void TightenMightSee(const VisMap &map, MightSeeTable &mightSee, const JobPool &jobs) const;

  private:
    void Make(const VisMap &map, const MightSeeTable &mightSee, std::size_t p);

    std::vector<std::size_t> start_;   ///< by portal: its first row of table_
    std::size_t rows_ = 0, words_ = 0; ///< number of rows, and words of a row
    std::unique_ptr<BitWord[]> table_;
};

/// The portals that a part of the first round computes, by portal: those next to each other in the file, which are
/// neighbors in the map.
std::vector<std::uint8_t> OwnPortals(const VisMap &map, const VisUnits &units);

/// How portal flow searches.
struct FlowSettings {
    const Passages *passages = nullptr; ///< nullptr: none
    bool clip = true;                   ///< clip windings by separators; else only passages restrict chains
    /// Reference mode: one portal after the other, without results of twins, and only the separators that the
    /// established algorithm finds.
    bool reference = false;
    int rounds = 0; ///< VisOptions::flowRounds
};

/// Replaces the row of every portal, taken in the given order, by the portals that chains from it reach. The
/// result does not depend on the number of workers.
/// units: rows that are known are not searched again.
void PortalFlow(const VisMap &map, std::span<const int> order, const FlowSettings &settings, const VisUnits &units,
                const JobPool &jobs, Log &log, MightSeeTable &mightSee);

/// Computes and keeps the rows of a part of a round of flow; mightSee: before the flow.
void PartOfPortalFlow(const VisMap &map, std::span<const int> order, const FlowSettings &settings,
                      const VisUnits &units, const JobPool &jobs, Log &log, MightSeeTable &mightSee);

} // namespace q3
