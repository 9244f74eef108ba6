// GPL-2.0-or-later. Named sets of options: -preset.
#pragma once

#include "q3map2/stages.h"

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

} // namespace q3
