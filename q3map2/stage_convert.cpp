// GPL-2.0-or-later. q3map2 -json, -info and -shpreview.
#include "common/error.h"
#include "q3map2/convert/bsp_info.h"
#include "q3map2/convert/convert_options.h"
#include "q3map2/convert/json/convert_json.h"
#include "q3map2/convert/json/convert_json_pack.h"
#include "q3map2/convert/preview/grid_preview.h"
#include "q3map2/engine_memory.h"
#include "q3map2/file_guard.h"
#include "q3map2/stage_words.h"

namespace q3 {

int JsonStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    const JsonOptions options = ParseJsonOptions(arguments, log);
    const std::string file = TakeFile(context, arguments, {}).file;
    const auto bspPath = options.pack ? MapPath(file, ".bsp") : ExistingBsp(file);
    const auto folder = WithExtension(bspPath, "");
    const BspFormat format = context.options.Format();
    const Game &game = *context.options.game;
    if (!options.pack) {
        log.Section("Unpack to JSON");
        FileGuard guard(context);
        guard.Needs(bspPath);
        guard.WritesInto(folder, SizeOfFile(bspPath) * 2);
        UnpackJson(ReadBspFile(bspPath, format, log), game, folder, log);
        return 0;
    }
    log.Section("Pack from JSON");
    auto packed = bspPath;
    packed.replace_filename(bspPath.stem().string() + "_json.bsp");
    FileGuard(context).Writes(packed, SizeOfFile(bspPath));
    const Bsp bsp = PackJson(folder, game,
                             {.useFlagNames = options.useFlagNames, .dropUnknownFlags = options.dropUnknownFlags}, log);
    WriteBspFile(packed, bsp, format, log);
    WarnOfEngineMemory(packed, bsp, game, log);
    return 0;
}

int InfoStage(const StageContext &context, Arguments arguments) {
    const std::vector<std::string> files = TakeFiles(context, arguments);
    if (files.empty()) {
        context.log.Print("No files to dump info for.\n");
        return 255;
    }
    for (const std::string &file : files) {
        const auto path = ExistingBsp(file);
        const Bsp bsp = ReadBspFile(path, context.options.Format(), context.log);
        PrintBspInfo(path, bsp, std::filesystem::file_size(path), context.log);
    }
    return 0;
}

int PreviewStage(const StageContext &context, Arguments arguments) {
    const std::vector<std::string> files = TakeFiles(context, arguments);
    if (files.size() != 2)
        throw Error("usage: q3map2 {}", context.stage.usage);
    const auto path = ExistingBsp(files[1]);
    FileGuard guard(context);
    guard.Needs(path);
    guard.Writes(files[0]);
    WriteGridPreview(files[0], ReadBspFile(path, context.options.Format(), context.log), context.log);
    return 0;
}

} // namespace q3
