// GPL-2.0-or-later. q3map2 -convertgrid.
#include "common/error.h"
#include "q3map2/bot_check.h"
#include "q3map2/command_record.h"
#include "q3map2/engine_memory.h"
#include "q3map2/file_guard.h"
#include "q3map2/grid_format_files.h"
#include "q3map2/gridformats/grid_format_options.h"
#include "q3map2/run_report.h"
#include "q3map2/stage_words.h"

namespace q3 {

int ConvertGridStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    const std::vector<std::string> given = arguments.Rest();
    log.Section("Convert light grid");
    const ConvertGridOptions options = ParseConvertGridOptions(arguments, context.options.game->gridAmbientScale, log);
    const StageFile file = TakeFile(context, arguments, given);
    PrintChangedOptions(arguments, log);
    const GridFormats formats = ParseGridFormats(options.formats);
    const auto input = ExistingBsp(file.file);
    const auto output =
        options.output.empty() ? input : WithExtension(std::filesystem::absolute(options.output), ".bsp");
    std::error_code none;
    if (!KeepSource(formats) && (output == input || std::filesystem::equivalent(output, input, none)))
        throw Error(
            "-gridformats {}: {} would lose its SH grid: add sh, shbspx or sparse, or name another file with -out",
            options.formats, input.string());

    FileGuard guard(context);
    guard.Needs(input);
    guard.Writes(output, SizeOfFile(input));
    log.Print("Loading {}\n", input.string());
    const BspFormat format = context.options.Format();
    Bsp bsp = ReadBspFile(input, format, log);
    std::vector<GridFile> files;
    try {
        GridStoring storing{.ambientFactor = double(options.ambientFactor)};
        if (options.givenSparse)
            storing.sparse = options.sparse;
        files = StoreGridFormats(bsp, formats, storing, JobPool(context.options.threads), log);
    } catch (const Error &error) {
        throw Error("{}: {}", input.string(), error.what());
    }
    RecordCommand(bsp, "-convertgrid", input.string(), file.recorded);
    guard.CheckUnchanged();
    WriteGridFiles(WithExtension(output, ""), files, log);
    const BotCheck bots(output, log);
    WriteBspFile(output, bsp, format, log);
    WarnOfEngineMemory(output, bsp, *context.options.game, log);
    bots.Report(BotCheck::SameGeometry, options.fixBotFiles);
    return 0;
}

} // namespace q3
