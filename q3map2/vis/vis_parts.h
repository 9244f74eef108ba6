// GPL-2.0-or-later. Portal visibility in parts on several machines: what each round computes and what joins know.
#pragma once

#include "libs/math/bit_table.h"
#include "q3map2/units/unit_store.h"
#include "q3map2/vis/vis_map.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace q3 {

/// The rounds of the vis stage (PartOptions). The first gives rows of the flood and of passages. In the others the
/// portal flow follows the portals in order, a third of them in each round, from what the rounds before found. That is
/// less than a single machine knows, which uses the rows of all portals before: each row S that a part finds contains
/// the row that a single machine finds. So the last join runs the flow of a single machine, and for each portal follows
/// chains inside S only. Its result is the same, and most of the work has been done: chains that lead nowhere.
inline constexpr int kFlowRounds = 3;
/// flows: whether there is a portal flow that can be divided.
inline int VisRounds(bool flows) {
    return flows ? 1 + kFlowRounds : 1;
}

/// Rows of bits as units of a store.
class VisUnits {
  public:
    enum class Row {
        Flood,   ///< of a portal: FloodMightSee
        Passage, ///< of a portal: its passages one after another, as if both of their ends saw all that the flood gives
        Flow     ///< of a portal: what the portal flow of a part finds
    };
    /// units: null, or of the purpose Parts.
    explicit VisUnits(UnitStore *units) : units_(units) {}

    /// Whether this process computes part of the first round, or of a later one.
    bool IsFirstPart() const { return units_ && units_->IsPartOfFirstRound(); }
    bool IsFlowPart() const { return units_ && units_->IsPart() && !IsFirstPart(); }
    /// Whether this process only joins, before a round of flow.
    bool EndsBeforeFlow() const { return units_ && units_->endsWithFile; }
    /// Whether results of the first round are there.
    bool HasFirstRound() const { return units_ && units_->roundsBefore > 0; }
    /// Rounds of flow whose results are there.
    int FlowRoundsBefore() const { return units_ ? std::max(0, units_->roundsBefore - 1) : 0; }

    void Keep(Row kind, std::size_t portal, std::span<const BitWord> words) const;
    /// False: it is not there.
    bool Find(Row kind, std::size_t portal, std::span<BitWord> words) const;
    std::vector<std::uint8_t> Own(std::span<const double> costs, UnitStore::Division division) const {
        return units_->Own(costs, division);
    }

    /// The state before the portal flow: what may be seen, and passages. It replaces all results of the first round.
    void KeepState(std::span<const BitWord> mightSee, std::span<const BitWord> passages) const;
    bool FindState(std::span<BitWord> mightSee, std::span<BitWord> passages) const;

  private:
    UnitStore *units_;
};

} // namespace q3
