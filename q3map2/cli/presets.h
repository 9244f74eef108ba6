// GPL-2.0-or-later. Options that stand for others: named sets of options (-preset), and the options of VRAD.
#pragma once

#include "q3map2/cli/program.h"

#include <span>

namespace q3 {

/// The options that a preset stands for in each stage, as they would stand on the command line.
struct Preset {
    std::string_view name;
    std::string_view help; ///< one sentence without its full stop
    std::string_view bsp, vis, light;
    std::string_view gridSH; ///< after those of `light`, if the line asks for an SH grid
};

std::span<const Preset> Presets();

/// Replaces `-preset NAME` in the arguments of a stage that has presets by its options, and prints them. They come
/// first, so that options on the line override them. Errors: no name, an unknown one, more than one preset.
void ExpandPreset(const Stage &stage, Arguments &arguments, Log &log);

/// What is printed about -preset, in the stages that have presets.
SettingSection PresetSection();

/// An option of VRAD that the light stage does not have under that name.
struct VradOption {
    std::string_view name;
    std::string_view values, example; ///< as in SettingInfo
    std::string_view replacement;     ///< options that mean about the same, N being the value; empty: it does nothing
    std::string_view advice;          ///< what to use instead, or why there is nothing

    /// Its declaration, without the help.
    SettingInfo Info() const {
        return {.name = name,
                .values = values,
                .kind = values.empty() ? SettingKind::Flag : SettingKind::Text,
                .since = "VRAD",
                .example = example};
    }
};

std::span<const VradOption> VradOptions();

/// Replaces options of VRAD in the arguments of the light stage and prints what each became; takes the others off with
/// a warning that names what to use here. Before ExpandPreset.
void TranslateVradOptions(const Stage &stage, Arguments &arguments, Log &log);

/// What is printed about them.
SettingSection VradSection();

} // namespace q3
