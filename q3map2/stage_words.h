// GPL-2.0-or-later. Which stage a command line means, and which file.
#pragma once

#include "q3map2/stages.h"

namespace q3 {

/// A stage of Stages() and whether the line names it.
struct ChosenStage {
    Stage stage;
    bool given = false;
};

/// Takes the stage word off `arguments`, from which the global options are gone. It may stand anywhere; without one the
/// bsp stage is meant. Errors: no words at all, two stages, and names of stages that this program does not have.
ChosenStage TakeStage(Arguments &arguments);

/// The file of a stage, and its options as the map records them: without the file.
struct StageFile {
    std::string file;
    std::vector<std::string> recorded;
};

/// Takes the file off `arguments`, from which the options of the stage are gone: the last word without a dash. `given`
/// are the words before the options were taken. Then whatever is left is unknown: a warning, or an error if it stands
/// before the stage word or there is none. Errors: no file, or no telling which word is the file.
StageFile TakeFile(const StageContext &context, Arguments &arguments, std::vector<std::string> given);
/// The same for a stage that takes any number of files.
std::vector<std::string> TakeFiles(const StageContext &context, Arguments &arguments);

} // namespace q3
