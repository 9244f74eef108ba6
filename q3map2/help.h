// GPL-2.0-or-later. q3map2 -help.
#pragma once

#include "common/log.h"

#include <string>
#include <string_view>

namespace q3 {

/// What -help TOPIC prints: a stage, an option or a key by its name, "game", "keys", "all", or a generated file
/// (documentation.h). Without a topic an overview. Errors: an unknown topic.
std::string HelpText(std::string_view topic);

} // namespace q3
