// GPL-2.0-or-later. Documentation of the directives of shader scripts.
#pragma once

#include "common/setting_info.h"

#include <string>
#include <vector>

namespace q3 {

inline constexpr std::string_view kDirectiveRules =
    "A directive is a line of a shader in a script of the game (`scripts/*.shader`). Names have no case; parentheses "
    "around numbers may be left out, and the rest of a line after its values is not read. A faulty line is a warning "
    "that names the script, the line and the shader, and has no effect. Words of engines that are not listed here are "
    "passed over; an unknown word that begins with `q3map_` is a warning with the nearest name. Light is counted in "
    "bytes: 255 is full light, before gamma and tone.";

/// All directives and words of stages that the compiler reads, by subject.
std::vector<SettingSection> DirectiveSections();

} // namespace q3
