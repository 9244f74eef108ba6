// GPL-2.0-or-later. q3map2 -shreport.
#include "common/files/files.h"
#include "q3map2/file_guard.h"
#include "q3map2/game_check.h"
#include "q3map2/run_report.h"
#include "q3map2/shreport/report_package.h"
#include "q3map2/shreport/shreport_options.h"
#include "q3map2/shreport/viewer_page.h"
#include "q3map2/stage_words.h"

namespace q3 {

int ShReportStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    log.Section("SH report");
    const ShReportOptions options = ParseShReportOptions(arguments, log);
    const auto bspPath = ExistingBsp(TakeFile(context, arguments, {}).file);
    PrintChangedOptions(arguments, log);
    const auto path =
        options.output.empty() ? WithExtension(bspPath, ".html") : std::filesystem::absolute(options.output);
    FileGuard guard(context);
    guard.Needs(bspPath);
    guard.Writes(path, SizeOfFile(bspPath) / 4);
    const auto folders = GameFolders(context.options, context.words, context.program);
    if (options.textureSize > 0)
        RequireGameFiles(context.options, folders, context.words, log);
    const VirtualFileSystem vfs = OpenGameFiles(context.options, folders, log);
    log.Print("Loading {}\n", bspPath.string());
    const Bsp bsp = ReadBspFile(bspPath, context.options.Format(), log);
    const std::filesystem::path folder = GameFolderOfMap(bspPath.string());
    const PackageSource source(vfs, folder.empty() ? std::vector<std::filesystem::path>{} : std::vector{folder}, {});
    const Game &game = *context.options.game;
    const EngineScripts scripts = ReadScripts(source, game, log);
    const JobPool jobs(context.options.threads);
    const std::vector<std::byte> package =
        MakeReportPackage({bspPath, bsp, game, source, scripts}, options.textureSize, jobs, log);
    const std::string page =
        PageWithPackage(ViewerPage(), fmt::format("maps/{}.bsp", bspPath.stem().string()), package);
    log.Print("Writing {}\n", path.string());
    ReplaceTextFile(path, page);
    log.Print("Wrote {} bytes, with a package of {} bytes\n", page.size(), package.size());
    return 0;
}

} // namespace q3
