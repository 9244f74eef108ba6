// GPL-2.0-or-later. Portal visibility in parts on several machines: what each round computes and what joins know.
#pragma once

#include "libs/math/bit_table.h"
#include "q3map2/units/unit_store.h"
#include "q3map2/vis/passages.h"
#include "q3map2/vis/vis_map.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace q3 {

// The rounds of the vis stage (PartOptions): the first gives rows of the flood and of passages. Each of the others is a
// round of the portal flow (VisOptions::flowRounds).

/// Rounds of the flow of a run in parts, unless -flowrounds says otherwise. With more rounds less is searched in vain,
/// since each starts from the rows of those before, but all parts wait for each other more often.
inline constexpr int kFlowRoundsOfParts = 4;

/// Rows of bits as units of a store.
class VisUnits {
  public:
    enum class Row {
        Flood, ///< of a portal: FloodMightSee
        Flow   ///< of a portal: what the portal flow finds
    };
    /// units: null, or of the purpose Parts; map: needed by the latter.
    explicit VisUnits(UnitStore *units, const VisMap *map = nullptr) : units_(units), map_(map) {}

    /// Whether results are kept or looked for at all.
    bool HasStore() const { return units_ != nullptr; }
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
    /// False: it is not there or damaged, and `words` are undefined.
    bool Find(Row kind, std::size_t portal, std::span<BitWord> words) const;
    /// The passages of a portal, dense rows one after another. A part keeps them as if both of their ends saw all that
    /// the flood gives.
    void KeepPassages(std::size_t portal, std::span<const BitWord> rows) const;
    bool FindPassages(std::size_t portal, std::span<BitWord> rows) const;
    std::vector<std::uint8_t> Own(std::span<const double> costs, UnitStore::Division division) const {
        return units_->Own(costs, division);
    }

    /// The state before the portal flow: what may be seen, and passages. It replaces all results of the first round.
    void KeepState(const MightSeeTable &mightSee, const Passages *passages) const;
    /// False: the state is not there.
    bool FindState(MightSeeTable &mightSee, std::optional<Passages> &passages) const;

  private:
    UnitStore *units_;
    const VisMap *map_;
};

} // namespace q3
