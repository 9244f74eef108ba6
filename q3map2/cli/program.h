// GPL-2.0-or-later. From the command line to a stage: what a stage is and gets, which one is meant, and its run.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "common/settings.h"
#include "q3map2/cli/global_options.h"

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

struct Stage;
class RunReport;

/// All stages of the program; the first is the one that runs without a stage word.
using StageList = std::span<const Stage>;

/// What a stage gets besides its arguments.
struct StageContext {
    const GlobalOptions &options;
    const Stage &stage;
    StageList stages;               ///< all of them, for hints about words of other stages
    bool stageIsNamed;              ///< false: no stage word, which means the bsp stage
    std::filesystem::path program;  ///< real path of the executable
    std::vector<std::string> words; ///< the whole command line, which may contain the engine path
    Log &log;
    RunReport &report;
    std::vector<std::string> given{}; ///< the command line, with its global options and as it was before presets
};

/// A word such as -light and what it starts.
struct Stage {
    std::string_view word;  ///< with its dash
    std::string_view usage; ///< what follows "q3map2 "
    std::string_view help;  ///< one sentence without its full stop
    std::string_view intro; ///< for the documentation page
    int (*run)(const StageContext &, Arguments);
    std::vector<SettingSection> (*settings)(); ///< null: no options of its own

    /// The words that the value of an option may be, for completion; null or an empty list: the option's help says so.
    std::vector<std::string> (*choices)(std::string_view option) = nullptr;
    /// What follows the option in examples of the documentation.
    std::string_view exampleFiles = "maps/mymap.bsp";

    /// Names and aliases of its options and of those that every stage accepts.
    std::vector<std::string> OptionNames() const;
    bool HasOption(std::string_view word) const;
};

/// The input file of a stage, and the other words of the command line.
struct StageFile {
    std::string file;
    std::vector<std::string> wordsToRecord; ///< in worldspawn's key _q3map2_cmdline
};

/// Takes the input file off `arguments`, after the options of the stage were taken: the last word without a dash.
/// `given`: the words before the options were taken. Each other word left is unknown: a warning, or an error if it
/// stands before the stage word, if no stage was named, or if it is an option that seems to name a file: its name ends
/// in file, path or dir, or a word with a slash or the extension of a file follows it. A number after it is never a
/// file. Errors: no file, or it is unclear which word is the file.
StageFile TakeFile(const StageContext &context, Arguments &arguments, std::vector<std::string> given);
/// Takes all words without a dash off `arguments`, as files; there may be none. Options left are unknown, as above.
std::vector<std::string> TakeFiles(const StageContext &context, Arguments &arguments);

/// A stage of the list and whether the line names it.
struct ChosenStage {
    Stage stage;
    bool isNamed = false;
};

/// Takes the stage word off `arguments`, after the global options were taken. It may stand anywhere; without one the
/// first of `stages` is meant. Errors: no words at all, two stages, and a first word that is a stage of other compilers
/// only.
ChosenStage TakeStage(StageList stages, Arguments &arguments);

/// How the error of a run is printed: this line, then one that says what is wrong.
inline constexpr std::string_view kErrorHeader = "************ ERROR ************\n";
/// That line of a run without memory.
inline constexpr std::string_view kOutOfMemory = "out of memory";

/// The whole program: parses the command line, runs the stage, prints failures. Returns the exit status. `program`:
/// real path of the executable.
int RunProgram(StageList stages, const std::vector<std::string> &arguments, const std::filesystem::path &program,
               Log &log);

} // namespace q3
