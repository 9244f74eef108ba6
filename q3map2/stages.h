// GPL-2.0-or-later. The stages that the command line can name.
#pragma once

#include "common/arguments.h"
#include "q3map2/global_options.h"

#include <filesystem>
#include <string>
#include <vector>

namespace q3 {

inline constexpr std::string_view kVersion = "q3map2-sh 0.1.0";

/// What a stage gets besides its arguments.
struct StageContext {
    const GlobalOptions &options;
    std::filesystem::path program;  ///< real path of the executable
    std::vector<std::string> words; ///< all words of the command line, to find the engine path in
    Log &log;
};

// Each takes its options off `arguments`, whose stage word is gone already, and returns the exit status.
int BspStage(const StageContext &context, Arguments arguments);
int LightStage(const StageContext &context, Arguments arguments);
int VisStage(const StageContext &context, Arguments arguments);
int ExportStage(const StageContext &context, Arguments arguments);
int ImportStage(const StageContext &context, Arguments arguments);
int JsonStage(const StageContext &context, Arguments arguments);
int InfoStage(const StageContext &context, Arguments arguments);
int PreviewStage(const StageContext &context, Arguments arguments);

/// -help: the text of a topic, or of all.
void PrintUsage(std::string_view topic, Log &log);

/// The path with its extension (if any) replaced.
std::filesystem::path WithExtension(const std::filesystem::path &path, std::string_view extension);

/// The whole program: parses the command line, runs the stage, prints failures. Returns the exit status.
int RunProgram(const std::vector<std::string> &arguments, const std::filesystem::path &program, Log &log);

} // namespace q3
