// GPL-2.0-or-later. q3map2 -watch: a map source that is built and shown at each save.
#include "common/error.h"
#include "q3map2/stages/stages.h"
#include "q3map2/watch/options/watch_options.h"

#ifdef Q3MAP2_WATCH
#include "common/text/text.h"
#include "q3map2/cli/global_options.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/report/run_report.h"
#include "q3map2/shreport/report_page.h"
#include "q3map2/watch/watch_session.h"

#include <algorithm>
#include <optional>
#endif

namespace q3 {

#ifdef Q3MAP2_WATCH

namespace {

namespace fs = std::filesystem;

/// What decides which shaders and images the page needs, but for the game's files.
std::string KeyOf(const MapNeeds &needs) {
    std::string key;
    for (const Wanted &shader : needs.shaders.All())
        key += shader.name + '\n';
    return key;
}

/// Makes the packages of the page. Called from one thread at a time.
Resources::Make PackageMaker(const StageContext &context, const MapFiles &files, int textureSize) {
    auto last = std::make_shared<std::optional<std::string>>(); // KeyOf the latest package
    // The context outlives the session.
    return [=, &context](Resources::Reason reason) -> std::optional<std::vector<std::byte>> {
        const Game &game = *context.options.game;
        Log silent(Log::Nowhere());
        const Bsp bsp = ReadBspFile(files.bsp, context.options.Format(), silent);
        MapNeeds needs;
        AddNeeds(bsp, files.bsp.stem().string(), game, needs);
        std::string key = KeyOf(needs);
        if (reason == Resources::Reason::MapChanged && *last == key && needs.externalPages.All().empty())
            return std::nullopt;
        const auto folders = GameFolders(context.options, context.words, context.program);
        const VirtualFileSystem vfs = OpenGameFiles(context.options, folders, silent, context.words);
        const fs::path folder = GameFolderOfMap(files.bsp.string());
        const PackageSource source(vfs, folder.empty() ? std::vector<fs::path>{} : std::vector{folder}, {});
        const EngineScripts scripts = ReadScripts(source, game, silent);
        const JobPool jobs(context.options.threads);
        auto package = MakeResourcePackage({files.bsp, bsp, game, source, scripts}, textureSize, jobs, silent);
        *last = std::move(key);
        return package;
    };
}

} // namespace

int WatchStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    log.Section("Watch");
    const WatchOptions options = ParseWatchOptions(arguments, log);
    const std::vector<std::string> given = arguments.Rest();
    const StageFile file = TakeFile(context, arguments, given);
    PrintChangedOptions(arguments, log);
    const fs::path map = MapPath(file.file, ".map");
    const auto folders = GameFolders(context.options, context.words, context.program);
    RequireMap(map, folders);
    RequireGameFiles(context.options, folders, context.words, log);
    const MapFiles files = FilesOf(map);
    WatchSession session(
        {.program = context.program,
         .globalWords = GlobalWords(context.given, std::array<std::string_view, 3>{"-connect", "-log", "-report"}),
         .options = options,
         .files = files,
         .game = *context.options.game},
        PackageMaker(context, files, options.textureSize), log);
    const std::string address = session.Address();
    session.Run([&] { // from here on, Ctrl-C ends it in order
        log.Print("Watching {} until Ctrl-C\n", map.string());
        log.WriteLive(fmt::format("The page: {}\n", address)); // not to the file of -log: whoever knows it sees the map
        ErrorOut error;
        if (options.open && !g_app_info_launch_default_for_uri(address.c_str(), nullptr, &error))
            log.Warn("browser", "-open: no browser could be started: {}", error.Text());
    });
    log.Print("The watch of {} has ended\n", map.string());
    return 0;
}

#else

int WatchStage(const StageContext &, Arguments) {
    throw Error("this build of the program has no -watch: it was built without libsoup (-DQ3MAP2_WATCH=OFF)");
}

#endif

} // namespace q3
