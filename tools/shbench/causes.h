// GPL-2.0-or-later. Why a grid errs at a position, by rules on what the points around it see.
#pragma once

#include "tools/shbench/errors.h"

#include <array>
#include <span>
#include <string_view>
#include <vector>

namespace q3::bench {

/// In the order of the rules: the first that holds is the cause. "Accounts for": alone it makes a displayed RMS error
/// of more than half of the grid error.
enum class Cause {
    Floor,        ///< the error of the exact projection is over 0.7 of the error: nothing to gain
    ShadowEdge,   ///< what the corners see of the lights, blended, is not what the position sees, which accounts for it
    NearLight,    ///< lights nearer than two cells, falling off between the corners, account for it
    Wall,         ///< a corner is in solid, or behind something as seen from the position
    Interpolation ///< none of these
};
inline constexpr std::size_t kCauses = 5;
std::string_view NameOf(Cause cause);

/// Cause at one position, which `layout` has its eight corners around. `errors` as of ErrorsAt.
Cause FindCause(const BenchMap &map, const GridLayout &layout, const TruthPoint &point, const PlaceErrors &errors);

/// The same for every position, on all workers.
std::vector<Cause> FindCauses(const BenchMap &map, const GridLayout &layout, const Truth &truth,
                              std::span<const PlaceErrors> errors, const JobPool &jobs);

/// Share of one cause.
struct CauseShare {
    double positions = 0; ///< of all positions
    double error = 0;     ///< of the sum of squared grid errors
};
/// By cause, in their order. Nothing but zeros without errors.
std::array<CauseShare, kCauses> SharesByCause(std::span<const Cause> causes, std::span<const PlaceErrors> errors);

} // namespace q3::bench
