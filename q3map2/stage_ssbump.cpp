// GPL-2.0-or-later. q3map2 -ssbump.
#include "common/error.h"
#include "q3map2/file_guard.h"
#include "q3map2/run_report.h"
#include "q3map2/ssbump/ssbump_files.h"
#include "q3map2/stage_words.h"

namespace q3 {

int SsbumpStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    log.Section("Self-shadowed bump map");
    const SsbumpOptions options = ParseSsbumpOptions(arguments, log);
    const std::vector<std::string> files = TakeFiles(context, arguments);
    if (files.size() != 2)
        throw Error("usage: q3map2 {}", context.stage.usage);
    PrintChangedOptions(arguments, log);
    FileGuard guard(context);
    guard.Needs(std::filesystem::absolute(files[0]));
    guard.Writes(std::filesystem::absolute(files[1]), SizeOfFile(files[0]) / 4);
    const JobPool jobs(context.options.threads);
    WriteSsbump(std::filesystem::absolute(files[0]), std::filesystem::absolute(files[1]), options, jobs, log);
    return 0;
}

} // namespace q3
