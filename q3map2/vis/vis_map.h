// GPL-2.0-or-later. What the passes over portals read. Internal to the folder.
#pragma once

#include "q3map2/vis/bit_table.h"
#include "q3map2/vis/portal_graph.h"
#include "q3map2/vis/vis.h"

#include <span>
#include <vector>

namespace q3 {

/// A portal as the passes need it: small, and all of them in one run of memory.
struct alignas(16) FlowPortal {
    VisPlane plane; ///< normal into `leaf`
    Vec3f centre;
    float radius = 0;
    WindingView winding;
    int leaf = 0; ///< where it leads
    bool sky = false, removed = false;
    bool hasTwin = false; ///< portal ^ 1 is the same opening the other way
};

/// The graph in the form for the passes. Does not change.
class VisMap {
  public:
    /// With `widestFirst` the portals out of a leaf are in order of their radius, else in that of the file.
    VisMap(const PortalGraph &graph, bool widestFirst);
    VisMap(const VisMap &) = delete;
    VisMap &operator=(const VisMap &) = delete;

    std::size_t NumPortals() const { return portals_.size(); }
    const FlowPortal &Portal(std::size_t index) const { return portals_[index]; }
    /// Portals that lead out of a leaf, without removed ones.
    std::span<const int> PortalsOf(int leaf) const {
        const auto first = std::size_t(leafFirst_[std::size_t(leaf)]);
        return {leafPortals_.data() + first, std::size_t(leafFirst_[std::size_t(leaf) + 1]) - first};
    }
    /// Those that lead out of the leaf that a portal leads to.
    std::span<const int> PortalsAfter(std::size_t portal) const { return PortalsOf(portals_[portal].leaf); }

  private:
    std::vector<FlowPortal> portals_;
    std::vector<int> leafFirst_, leafPortals_;
    std::vector<float> points_;
};

/// Row p: the portals that may be seen through portal p.
using SightTable = BitTable;

/// What is in front of each portal and can be reached without turning round.
SightTable FloodSight(const VisMap &map, const FarPlane &farPlane, const JobPool &jobs, Log &log);

/// What is seen one way is seen the other way: clears bits whose twin is clear.
void ApplySymmetry(const VisMap &map, SightTable &sight);

/// Portals by the number of bits of their rows, least first; in order of their index if not `sorted`.
std::vector<int> OrderPortals(const VisMap &map, const SightTable &sight, bool sorted);

/// For a portal and each that follows it: what may be seen through both.
class Passages {
  public:
    /// Bytes that they would take.
    static std::uint64_t BytesFor(const VisMap &map);
    Passages(const VisMap &map, const SightTable &sight, const JobPool &jobs, Log &log);

    /// Of portal `first` and the portal at `place` in VisMap::PortalsAfter(first).
    const BitWord *Row(std::size_t first, std::size_t place) const { return table_.Row(start_[first] + place); }

    /// Takes out of the rows of `sight` what no portal that follows lets through, several times: rows that became
    /// smaller make others smaller.
    void Narrow(const VisMap &map, SightTable &sight, const JobPool &jobs) const;

  private:
    std::vector<std::size_t> start_;
    BitTable table_;
};

struct FlowSettings {
    const Passages *passages = nullptr; ///< nullptr: none
    bool clip = true;                   ///< clips windings; else passages alone decide
    bool alone = false; ///< one portal at a time, each direction for itself, separators as far as they were needed
};

/// Follows every portal in the given order and replaces its row by what it finds.
void PortalFlow(const VisMap &map, std::span<const int> order, const FlowSettings &settings, const JobPool &jobs,
                Log &log, SightTable &sight);

} // namespace q3
