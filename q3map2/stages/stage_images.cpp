// GPL-2.0-or-later. q3map2 -minimap, -ssbump and -tonemap: pictures.
#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"
#include "libs/math/packed_color.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/cli/global_options.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/convert/preview/tone_picture.h"
#include "q3map2/minimap/minimap.h"
#include "q3map2/report/run_report.h"
#include "q3map2/ssbump/ssbump.h"
#include "q3map2/stages/stages.h"
#include "q3map2/stages/written_map.h"

namespace q3 {

// ---- q3map2 -minimap ----

int MinimapStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    log.Section("MiniMap");
    const MinimapOptions options = ParseMinimapOptions(arguments, log);
    const auto bspPath = ExistingBsp(TakeFile(context, arguments, {}).file);
    PrintChangedOptions(arguments, log);
    const Game &game = *context.options.game;
    const auto output = options.Output(MinimapStyleOf(game.name), bspPath);
    FileGuard guard(context);
    guard.Needs(bspPath);
    guard.WritesInto(output.parent_path());
    if (std::filesystem::exists(output))
        guard.Writes(output);
    const auto folders = GameFolders(context.options, context.words, context.program);
    RequireGameFiles(context.options, folders, context.words, log);
    const VirtualFileSystem vfs = OpenGameFiles(context.options, folders, log, context.words);
    log.Print("Loading {}\n", bspPath.string());
    const Bsp bsp = ReadBspFile(bspPath, context.options.Format(), log);
    RequireFormatOfGame(bsp, bspPath, context.options);
    ShaderLibrary library(vfs, game, {}, log);
    const JobPool jobs(context.options.threads);
    WriteMinimap(bsp, bspPath, library, options, MinimapStyleOf(game.name), jobs, log);
    return 0;
}

// ---- q3map2 -ssbump ----

int SsbumpStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    log.Section("Self-shadowed bump map");
    const SsbumpOptions options = ParseSsbumpOptions(arguments, log);
    const std::vector<std::string> files = TakeFiles(context, arguments);
    if (files.size() != 2)
        throw Error("usage: q3map2 {}", context.stage.usage);
    PrintChangedOptions(arguments, log);
    const std::filesystem::path from = std::filesystem::absolute(files[0]), to = std::filesystem::absolute(files[1]);
    FileGuard guard(context);
    guard.Needs(from);
    guard.Writes(to, SizeOfFile(from) / 4); // a guess, as both files may be compressed
    const JobPool jobs(context.options.threads);
    WriteSsbump(from, to, options, jobs, log);
    return 0;
}

// ---- q3map2 -tonemap ----

namespace {

/// A page of LIGHTING_E5BGR9 in the row order of -export.
FloatImage HdrPageOf(const std::filesystem::path &path, const StageContext &context, int page) {
    const Bsp bsp = ReadBspFile(path, context.options.Format(), context.log);
    const int side = bsp.lightmapSide;
    const std::size_t texels = std::size_t(side) * std::size_t(side), pages = bsp.lightmapsE5bgr9.size() / texels;
    if (pages == 0)
        throw Error("{}: the map has no HDR lightmaps", path.string());
    if (std::size_t(page) >= pages)
        throw Error("{}: the map has no HDR lightmap {}, expected one of 0 to {}", path.string(), page, pages - 1);
    const auto codes = std::span(bsp.lightmapsE5bgr9).subspan(std::size_t(page) * texels, texels);
    return FlippedRows({side, side, DecodeE5bgr9(codes)});
}

void WritePicture(const std::filesystem::path &path, const Image &picture) {
    const std::string extension = path.extension().string();
    if (EqualNoCase(extension, ".png"))
        return WritePng(path, picture);
    if (!EqualNoCase(extension, ".tga"))
        throw Error("{}: unknown picture extension \"{}\", expected .png or .tga", path.string(), extension);
    std::vector<std::uint8_t> colors;
    for (std::size_t i = 0; i < picture.rgba.size(); ++i)
        if (i % 4 != 3)
            colors.push_back(picture.rgba[i]);
    ReplaceFile(path, EncodeTga(colors, picture.width, picture.height, 3, TgaRows::TopFirst));
}

} // namespace

int ToneMapStage(const StageContext &context, Arguments arguments) {
    const ToneMapOptions options = ParseToneMapOptions(arguments, context.log);
    const std::vector<std::string> files = TakeFiles(context, arguments);
    if (files.size() != 2)
        throw Error("usage: q3map2 {}", context.stage.usage);
    const std::filesystem::path from = std::filesystem::absolute(files[0]), to = std::filesystem::absolute(files[1]);
    FileGuard guard(context);
    guard.Needs(from);
    guard.Writes(to);
    const FloatImage image =
        EqualNoCase(from.extension().string(), ".bsp") ? HdrPageOf(from, context, options.page) : ReadFloatImage(from);
    WritePicture(to, ToneMapped(image, options));
    context.log.Print("Wrote {}\n", to.string());
    return 0;
}

} // namespace q3
