// GPL-2.0-or-later. q3map2 -exportents and -analyze.
#include "common/files/files.h"
#include "q3map2/convert/analyze.h"
#include "q3map2/convert/convert_options.h"
#include "q3map2/file_guard.h"
#include "q3map2/stage_words.h"

namespace q3 {

int ExportEntitiesStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    const auto bspPath = ExistingBsp(TakeFile(context, arguments, {}).file);
    const auto path = WithExtension(bspPath, ".ent");
    FileGuard guard(context);
    guard.Needs(bspPath);
    guard.Writes(path);
    log.Print("Loading {}\n", bspPath.string());
    const Bsp bsp = ReadBspFile(bspPath, context.options.Format(), log);
    const std::string text = bsp.entities.substr(0, bsp.entities.find('\0')) + "\n";
    if (text.size() == 1) {
        log.Warn("no entities", "{}: the map has no entities to write", bspPath.string());
        return 0;
    }
    log.Print("Writing {}\n", path.string());
    ReplaceTextFile(path, text);
    return 0;
}

int AnalyzeStage(const StageContext &context, Arguments arguments) {
    AnalyzeOptions options;
    TakeSettings(AnalyzeSettings(), options, arguments, context.log);
    std::filesystem::path path = std::filesystem::absolute(TakeFile(context, arguments, {}).file);
    if (!std::filesystem::is_regular_file(path))
        path = ExistingBsp(path.string());
    PrintAnalysis(ReadFile(path), options.lumpSwap, path.string(), context.log);
    return 0;
}

} // namespace q3
