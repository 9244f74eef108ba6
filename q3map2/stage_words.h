// GPL-2.0-or-later. Which stage a command line means, and which file.
#pragma once

#include "q3map2/stages.h"

namespace q3 {

/// A stage of Stages() and whether the line names it.
struct ChosenStage {
    Stage stage;
    bool given = false;
};

/// Takes the stage word off `arguments`, after the global options were taken. It may stand anywhere; without one the
/// bsp stage is meant. Errors: no words at all, two stages, and a first word that is a stage of other compilers only.
ChosenStage TakeStage(Arguments &arguments);

/// The input file of a stage, and the other words, for worldspawn's key _q3map2_cmdline.
struct StageFile {
    std::string file;
    std::vector<std::string> recorded;
};

/// Takes the input file off `arguments`, after the options of the stage were taken: the last word without a dash.
/// `given`: the words before the options were taken. Each other word left is unknown: a warning, or an error if it
/// stands before the stage word or no stage was named. Errors: no file, or it is unclear which word is the file.
StageFile TakeFile(const StageContext &context, Arguments &arguments, std::vector<std::string> given);
/// Takes all words without a dash off `arguments`, as files; there may be none. Options left are unknown, as above.
std::vector<std::string> TakeFiles(const StageContext &context, Arguments &arguments);

} // namespace q3
