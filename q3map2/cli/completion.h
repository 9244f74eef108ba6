// GPL-2.0-or-later. Completion of the command line in shells.
#pragma once

#include "q3map2/cli/program.h"

#include <string>

namespace q3 {

/// tools/generated/completions/q3map2.bash, _q3map2 and q3map2.fish.
std::string BashCompletion(StageList stages);
std::string ZshCompletion(StageList stages);
std::string FishCompletion(StageList stages);

} // namespace q3
