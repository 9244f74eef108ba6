// GPL-2.0-or-later. q3map2 -minimap.
#include "q3map2/file_guard.h"
#include "q3map2/game_check.h"
#include "q3map2/minimap/minimap.h"
#include "q3map2/run_report.h"
#include "q3map2/stage_words.h"

namespace q3 {

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
    const VirtualFileSystem vfs = OpenGameFiles(context.options, folders, log);
    log.Print("Loading {}\n", bspPath.string());
    const Bsp bsp = ReadBspFile(bspPath, context.options.Format(), log);
    ShaderLibrary library(vfs, game, {}, log);
    const JobPool jobs(context.options.threads);
    WriteMinimap(bsp, bspPath, library, options, MinimapStyleOf(game.name), jobs, log);
    return 0;
}

} // namespace q3
