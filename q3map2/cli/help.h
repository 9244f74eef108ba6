// GPL-2.0-or-later. q3map2 -help.
#pragma once

#include "q3map2/cli/program.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace q3 {

/// What -help TOPIC prints: a stage, an option or a key by its name, "game", "keys", "all", or a generated file
/// (reference_pages.h). Without a topic an overview. Errors: an unknown topic.
std::string HelpText(StageList stages, std::string_view topic);

/// The line of -help that says where the manual is, as HTML in the package that `program` (real path) belongs to.
std::string ManualLine(const std::filesystem::path &program);

} // namespace q3
