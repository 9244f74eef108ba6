// GPL-2.0-or-later. How fine a sparse SH grid is to be, and the options that say so.
#pragma once

#include "common/settings.h"

#include <optional>

namespace q3 {

/// The sparse grid is the smallest that meets the error, or the most accurate within the budget if there is one.
struct SparseGoal {
    float error = 1.5f;           ///< displayed error, measured or, where no light is traced, expected: RMS, bytes
    std::optional<double> budget; ///< size of the lump in bytes, in place of the error
};

/// The option -sherrortarget. goal(options) returns the goal to set; it is called once for each time the option is
/// given.
template <typename Options, typename GoalOf>
Setting<Options> ErrorTargetSetting(std::string_view help, std::string_view details, GoalOf goal) {
    return {{.name = "-sherrortarget",
             .values = "BYTES",
             .kind = SettingKind::Number,
             .unit = "255ths",
             .initial = "1.5",
             .range = {0.05, 64},
             .help = help,
             .details = details},
            Do<Options>([goal](Options &o, const SettingValues &v) { goal(o).error = float(v.numbers[0]); })};
}

/// The option -shbudget, likewise.
template <typename Options, typename GoalOf>
Setting<Options> BudgetSetting(std::string_view help, std::string_view details, GoalOf goal) {
    return {{.name = "-shbudget",
             .values = "MB",
             .kind = SettingKind::Number,
             .unit = "million bytes",
             .initial = "none",
             .range = {0.01, 2000},
             .help = help,
             .details = details},
            Do<Options>([goal](Options &o, const SettingValues &v) { goal(o).budget = v.numbers[0] * 1e6; })};
}

} // namespace q3
