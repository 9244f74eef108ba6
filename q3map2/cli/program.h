// GPL-2.0-or-later. The program: its stages, and the way from a command line to one of them.
#pragma once

#include "common/log.h"
#include "q3map2/stages/stage.h"

#include <filesystem>
#include <string>
#include <vector>

namespace q3 {

/// All stages; the first is the one that runs without a stage word.
std::vector<Stage> Stages();

/// A stage of Stages() and whether the line names it.
struct ChosenStage {
    Stage stage;
    bool isNamed = false;
};

/// Takes the stage word off `arguments`, after the global options were taken. It may stand anywhere; without one the
/// bsp stage is meant. Errors: no words at all, two stages, and a first word that is a stage of other compilers only.
ChosenStage TakeStage(Arguments &arguments);

/// The whole program: parses the command line, runs the stage, prints failures. Returns the exit status. `program`:
/// real path of the executable.
int RunProgram(const std::vector<std::string> &arguments, const std::filesystem::path &program, Log &log);

} // namespace q3
