// GPL-2.0-or-later. From the command line to a stage.
#pragma once

#include "common/log.h"
#include "q3map2/cli/stage.h"

#include <filesystem>
#include <string>
#include <vector>

namespace q3 {

/// The whole program: parses the command line, runs the stage, prints failures. Returns the exit status. `program`:
/// real path of the executable.
int RunProgram(StageList stages, const std::vector<std::string> &arguments, const std::filesystem::path &program,
               Log &log);

} // namespace q3
