// GPL-2.0-or-later. Why a grid is wrong at a position, by rules on what the points around it see.
#pragma once

#include "tools/measure/shbench/errors.h"

#include <array>
#include <span>
#include <string_view>
#include <vector>

namespace q3::bench {

/// In the order of the rules: the first that holds is the cause. "Accounts for": alone it makes a displayed RMS error
/// of more than half of the grid error.
enum class Cause {
    Floor,        ///< the exact projection alone has over 0.7 of the displayed error: no grid can do better
    ShadowEdge,   ///< corners and position see different shares of the lights, which accounts for it
    NearLight,    ///< lights nearer than two cells, falling off between the corners, account for it
    Wall,         ///< a corner is in solid, or behind something as seen from the position
    Interpolation ///< none of these
};
inline constexpr std::size_t kCauses = 5;
std::string_view NameOf(Cause cause);

/// Cause at one position of a grid with that layout. `errors`: from ErrorsAt.
Cause FindCause(const BenchMap &map, const GridLayout &layout, const TruthPoint &point, const PositionErrors &errors);

/// The same for every position, on all workers.
std::vector<Cause> FindCauses(const BenchMap &map, const GridLayout &layout, const Truth &truth,
                              std::span<const PositionErrors> errors, const JobPool &jobs);

/// Share of one cause.
struct CauseShare {
    double positions = 0; ///< of all positions
    double error = 0;     ///< of the sum of squared grid errors
};
/// Indexed by Cause. All zero without positions.
std::array<CauseShare, kCauses> SharesByCause(std::span<const Cause> causes, std::span<const PositionErrors> errors);

} // namespace q3::bench
