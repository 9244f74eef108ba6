// GPL-2.0-or-later. Passages: the portals that are seen through a pair of successive portals.
#pragma once

#include "q3map2/vis/vis_map.h"

#include <span>
#include <vector>

namespace q3 {

class VisUnits;

/// For each pair of successive portals of a chain: the portals that may be seen through both.
class Passages {
  public:
    /// limit: bytes of memory. Once the rows take that much, those of later portals are left out, so that more counts
    /// as seen; the rows of up to 256 portals may exceed it. Which ones are made does not depend on the number of
    /// threads. units: as in FloodMightSee.
    Passages(const VisMap &map, const MightSeeTable &mightSee, std::uint64_t limit, const VisUnits &units,
             const JobPool &jobs, Log &log);
    /// From rows that were computed before: by portal, those of VisMap::PortalsAfter. `made`: the portals with rows.
    Passages(const VisMap &map, SparseBitTable rows, std::size_t made);

    /// Portals seen through `first` and then through VisMap::PortalsAfter(first)[next]; null: the row was left out.
    const SparseBits *Row(std::size_t first, std::size_t next) const {
        return first < made_ ? &rows_[start_[first] + next] : nullptr;
    }
    const SparseBitTable &Rows() const { return rows_; }
    /// Number of portals whose rows are made: the first ones.
    std::size_t NumMade() const { return made_; }
    /// Number of rows of all portals, those left out included.
    static std::size_t NumRows(const VisMap &map);
    std::uint64_t Bytes() const { return rows_.Bytes(); }

    /// Restricts each row p to the union over next portals t of t itself and of passage(p, t) & row t, in several
    /// rounds, since a smaller row can shrink others.
    void TightenMightSee(const VisMap &map, MightSeeTable &mightSee, const JobPool &jobs) const;

  private:
    explicit Passages(const VisMap &map);

    std::vector<std::size_t> start_; ///< by portal: its first row; then the end of all
    SparseBitTable rows_;
    std::size_t made_ = 0;
};

} // namespace q3
