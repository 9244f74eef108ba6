// GPL-2.0-or-later. Completion of the command line in shells.
#pragma once

#include <string>

namespace q3 {

/// tools/completions/q3map2.bash, _q3map2 and q3map2.fish.
std::string BashCompletion();
std::string ZshCompletion();
std::string FishCompletion();

} // namespace q3
