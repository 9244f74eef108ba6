// GPL-2.0-or-later. Documentation of the directives of shader scripts.
#pragma once

#include "common/setting_info.h"

#include <string>
#include <vector>

namespace q3 {

inline constexpr std::string_view kDirectiveRules =
    "A directive is a line of a shader in a script of the game (`scripts/*.shader`). Names are case-insensitive; "
    "parentheses around numbers may be left out, and the rest of a line after its values is not read. A faulty line "
    "is a warning that names the script, the line and the shader, and has no effect. Words that are for engines and "
    "editors are ignored; any other unknown word is a warning, with the nearest name if there is one. Numbers are "
    "limited to plus and minus 1000000000. Light is given in 8-bit levels: 255 is full light, before gamma and tone.";

/// All directives and words of stages that the compiler reads, by subject.
std::vector<SettingSection> DirectiveSections();

} // namespace q3
