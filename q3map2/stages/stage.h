// GPL-2.0-or-later. What a stage is, what it gets, and the words that it takes off its line.
#pragma once

#include "common/arguments.h"
#include "common/settings.h"
#include "q3map2/stages/global_options.h"

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

struct Stage;
class RunReport;

/// What a stage gets besides its arguments.
struct StageContext {
    const GlobalOptions &options;
    const Stage &stage;
    std::span<const Stage> stages;  ///< all of them, for hints about words of other stages
    bool stageIsNamed;              ///< false: no stage word, which means the bsp stage
    std::filesystem::path program;  ///< real path of the executable
    std::vector<std::string> words; ///< the whole command line, which may contain the engine path
    Log &log;
    RunReport &report;
};

/// A word such as -light and what it starts.
struct Stage {
    std::string_view word;  ///< with its dash
    std::string_view usage; ///< what follows "q3map2 "
    std::string_view help;  ///< one sentence without its full stop
    std::string_view intro; ///< for the documentation page
    int (*run)(const StageContext &, Arguments);
    std::vector<SettingSection> (*settings)(); ///< null: no options of its own

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
/// stands before the stage word or no stage was named. Errors: no file, or it is unclear which word is the file.
StageFile TakeFile(const StageContext &context, Arguments &arguments, std::vector<std::string> given);
/// Takes all words without a dash off `arguments`, as files; there may be none. Options left are unknown, as above.
std::vector<std::string> TakeFiles(const StageContext &context, Arguments &arguments);

// The stages, each in the source stage_*.cpp of its words. Each takes its options off `arguments`, whose stage word is
// gone already, and returns the exit status.
int BspStage(const StageContext &context, Arguments arguments);
int LightStage(const StageContext &context, Arguments arguments);
int VisStage(const StageContext &context, Arguments arguments);
int ExportStage(const StageContext &context, Arguments arguments);
int ImportStage(const StageContext &context, Arguments arguments);
int ToneMapStage(const StageContext &context, Arguments arguments);
int JsonStage(const StageContext &context, Arguments arguments);
int ConvertStage(const StageContext &context, Arguments arguments);
int ConvertGridStage(const StageContext &context, Arguments arguments);
int InfoStage(const StageContext &context, Arguments arguments);
int MinimapStage(const StageContext &context, Arguments arguments);
int ExportEntitiesStage(const StageContext &context, Arguments arguments);
int AnalyzeStage(const StageContext &context, Arguments arguments);
int PreviewStage(const StageContext &context, Arguments arguments);
int SsbumpStage(const StageContext &context, Arguments arguments);
int PackStage(const StageContext &context, Arguments arguments);
int SHReportStage(const StageContext &context, Arguments arguments);
int RepackStage(const StageContext &context, Arguments arguments);
int ScaleStage(const StageContext &context, Arguments arguments);
int ShiftStage(const StageContext &context, Arguments arguments);
int MergeStage(const StageContext &context, Arguments arguments);
int FixAasStage(const StageContext &context, Arguments arguments);

/// The values of -format of the stage -convert.
std::vector<std::string> ConvertFormatNames();

} // namespace q3
