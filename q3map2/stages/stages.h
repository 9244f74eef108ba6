// GPL-2.0-or-later. The stages that the command line can name.
#pragma once

#include "q3map2/cli/program.h"

#include <vector>

namespace q3 {

/// All stages; the first is the one that runs without a stage word.
std::vector<Stage> Stages();

// The stages, each in the source stage_*.cpp of its words. Each takes its options off `arguments`, whose stage word is
// gone already, and returns the exit status.
int BspStage(const StageContext &context, Arguments arguments);
int LightStage(const StageContext &context, Arguments arguments);
int RecoverStage(const StageContext &context, Arguments arguments);
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
int WatchStage(const StageContext &context, Arguments arguments);
int SHReportStage(const StageContext &context, Arguments arguments);
int RepackStage(const StageContext &context, Arguments arguments);
int ScaleStage(const StageContext &context, Arguments arguments);
int ShiftStage(const StageContext &context, Arguments arguments);
int MergeStage(const StageContext &context, Arguments arguments);
int FixAasStage(const StageContext &context, Arguments arguments);

/// The words of the option -format of the stage -convert; none for others.
std::vector<std::string> ConvertChoices(std::string_view option);

} // namespace q3
