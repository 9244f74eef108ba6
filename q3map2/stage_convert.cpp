// GPL-2.0-or-later. q3map2 -json, -info and -shpreview.
#include "common/error.h"
#include "q3map2/convert/bsp_info.h"
#include "q3map2/convert/json/convert_json.h"
#include "q3map2/convert/json/convert_json_pack.h"
#include "q3map2/convert/preview/grid_preview.h"
#include "q3map2/stages.h"

namespace q3 {

int JsonStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    const bool pack = arguments.TakeFlag("-pack");
    const bool unpack = arguments.TakeFlag("-unpack");
    const PackJsonOptions options{.useFlagNames = arguments.TakeFlag("-useflagnames"),
                                  .skipFlags = arguments.TakeFlag("-skipflags")};
    if (pack && unpack)
        throw Error("-json: -pack and -unpack exclude each other");
    const std::string file = arguments.TakeLast();
    for (const std::string &word : arguments.Rest())
        log.Warn("unknown argument", "Unknown argument \"{}\"", word);
    if (file.empty()) {
        log.Print("Usage: q3map2 -json <-unpack|-pack [-useflagnames [-skipflags]]> maps/x.bsp\n");
        return 0;
    }
    const auto bspPath = WithExtension(std::filesystem::absolute(file), ".bsp");
    const auto folder = WithExtension(bspPath, "");
    const BspFormat format = context.options.Format();
    const Game &game = *context.options.game;
    if (!pack) {
        log.Section("Unpack to JSON");
        UnpackJson(ReadBspFile(bspPath, format, log), game, folder, log);
        return 0;
    }
    log.Section("Pack from JSON");
    auto packed = bspPath;
    packed.replace_filename(bspPath.stem().string() + "_json.bsp");
    WriteBspFile(packed, PackJson(folder, game, options, log), format, log);
    return 0;
}

int InfoStage(const StageContext &context, Arguments arguments) {
    if (arguments.Empty()) {
        context.log.Print("No files to dump info for.\n");
        return 255;
    }
    while (!arguments.Empty()) {
        const auto path = WithExtension(std::filesystem::absolute(arguments.TakeFirst()), ".bsp");
        const Bsp bsp = ReadBspFile(path, context.options.Format(), context.log);
        PrintBspInfo(path, bsp, std::filesystem::file_size(path), context.log);
    }
    return 0;
}

int PreviewStage(const StageContext &context, Arguments arguments) {
    const std::string file = arguments.TakeLast(), png = arguments.TakeLast();
    if (png.empty())
        throw Error("usage: q3map2 -shpreview FILE.png maps/x.bsp");
    const auto path = WithExtension(std::filesystem::absolute(file), ".bsp");
    WriteGridPreview(png, ReadBspFile(path, context.options.Format(), context.log), context.log);
    return 0;
}

} // namespace q3
