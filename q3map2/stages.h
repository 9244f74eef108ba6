// GPL-2.0-or-later. The stages that the command line can name.
#pragma once

#include "common/arguments.h"
#include "common/settings.h"
#include "q3map2/global_options.h"
#include "q3map2/map_paths.h"

#include <filesystem>
#include <string>
#include <vector>

namespace q3 {

struct Stage;
class RunReport;

/// What a stage gets besides its arguments.
struct StageContext {
    const GlobalOptions &options;
    const Stage &stage;
    bool stageGiven;                ///< false: no stage word, which means the bsp stage
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

/// All stages; the first is the one that runs without a stage word.
std::vector<Stage> Stages();
/// The options that every stage accepts.
std::vector<SettingSection> GlobalSections();

// Each takes its options off `arguments`, whose stage word is gone already, and returns the exit status.
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
int ShReportStage(const StageContext &context, Arguments arguments);
int RepackStage(const StageContext &context, Arguments arguments);
int ScaleStage(const StageContext &context, Arguments arguments);
int ShiftStage(const StageContext &context, Arguments arguments);
int MergeStage(const StageContext &context, Arguments arguments);
int FixAasStage(const StageContext &context, Arguments arguments);
int EditorFilesStage(const StageContext &context, Arguments arguments);

/// Error if a build step (editors/builds.h) names a stage, option or value that does not exist.
void CheckBuildStep(const std::string &step);

/// The values of -format of the stage -convert.
std::vector<std::string> ConvertFormatNames();

/// The whole program: parses the command line, runs the stage, prints failures. Returns the exit status.
int RunProgram(const std::vector<std::string> &arguments, const std::filesystem::path &program, Log &log);

} // namespace q3
