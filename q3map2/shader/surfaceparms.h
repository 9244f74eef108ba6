// GPL-2.0-or-later. The surfaceparm lists of the games table.
#pragma once

#include "q3map2/shader/games.h"

#include <vector>

namespace q3 {

/// The list of quake3, on which those of other games are based.
std::vector<SurfaceParm> BaseParms();
std::vector<SurfaceParm> QuakeLiveParms();
std::vector<SurfaceParm> TremulousParms();
std::vector<SurfaceParm> WolfParms();
std::vector<SurfaceParm> EnemyTerritoryParms();
std::vector<SurfaceParm> UrbanTerrorParms();
std::vector<SurfaceParm> EliteForceParms();
std::vector<SurfaceParm> ReactionParms();

} // namespace q3
