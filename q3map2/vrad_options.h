// GPL-2.0-or-later. Options of VRAD, Source's light compiler, for those who come from there.
#pragma once

#include "q3map2/stages.h"

#include <span>

namespace q3 {

/// An option of VRAD that the light stage does not have under that name.
struct VradOption {
    std::string_view name;
    int values = 0;               ///< words that follow
    std::string_view replacement; ///< options that mean about the same, N being the value; empty: refused
    std::string_view advice;      ///< what to use instead, or why there is nothing
};

std::span<const VradOption> VradOptions();

/// Replaces options of VRAD in the arguments of the light stage and prints what each became; takes the others off with
/// a warning that names what to use here. Before ExpandPreset.
void TranslateVradOptions(const Stage &stage, Arguments &arguments, Log &log);

/// What is printed about them.
SettingSection VradSection();

} // namespace q3
