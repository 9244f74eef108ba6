// GPL-2.0-or-later. Portal flow: the portals seen through a portal, by depth-first search over chains of portals.
#pragma once

#include "q3map2/vis/passages.h"
#include "q3map2/vis/vis_map.h"

#include <span>

namespace q3 {

class VisUnits;

/// How portal flow searches.
struct FlowSettings {
    const Passages *passages = nullptr; ///< nullptr: none
    bool clip = true;                   ///< clip windings by separators; else only passages restrict chains
    /// Reference mode: one portal after the other, without results of twins, and only the separators that the
    /// established algorithm finds.
    bool reference = false;
    int rounds = 0; ///< VisOptions::flowRounds
    /// Number of portals that a search tries to add before it keeps the chains that it follows (ExploredChains). Most
    /// searches end earlier, and keep none.
    int triesBeforeKeeping = 0;
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
