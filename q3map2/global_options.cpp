// GPL-2.0-or-later. Options that every stage accepts.
#include "q3map2/global_options.h"

#include "common/error.h"
#include "common/platform/platform.h"
#include "common/text/text.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/game_check.h"
#include "q3map2/global_settings.h"

#include <glib.h>

#include <algorithm>

namespace q3 {

namespace {

std::string WithSlashes(std::string path) {
    std::replace(path.begin(), path.end(), '\\', '/');
    return path;
}

void AddUnique(std::vector<std::string> &list, std::string value) {
    value = WithSlashes(std::move(value));
    if (std::none_of(list.begin(), list.end(), [&](const std::string &known) { return EqualNoCase(known, value); }))
        list.push_back(std::move(value));
}

/// Slashes instead of backslashes, and every path once.
void Normalize(std::vector<std::string> &list) {
    std::vector<std::string> unique;
    for (std::string &path : list)
        AddUnique(unique, std::move(path));
    list = std::move(unique);
}

void ChooseGame(GlobalOptions &options, Log &log) {
    options.game = FindGame("quake3");
    for (const std::string &name : options.games) {
        if (const Game *game = FindGame(name)) {
            options.game = game;
            continue;
        }
        ReportUnknownGame(name, options, log);
    }
}

/// Engine path: the first word that contains `magic`, cut after the path element with the match. Empty: none.
std::string EnginePathFrom(const std::vector<std::string> &words, std::string_view magic) {
    for (const std::string &word : words) {
        const std::string path = WithSlashes(word);
        const auto found = std::search(path.begin(), path.end(), magic.begin(), magic.end(),
                                       [](char a, char b) { return g_ascii_tolower(a) == g_ascii_tolower(b); });
        if (found == path.end())
            continue;
        const std::size_t slash = path.find('/', std::size_t(found - path.begin()));
        if (slash != std::string::npos)
            return path.substr(0, slash + 1);
    }
    return {};
}

/// The folder that holds the game folder of a map named on the command line: DIR of DIR/baseq3/maps/x.map. Empty: none.
std::string EnginePathOfMap(const std::vector<std::string> &words, const std::vector<std::string> &gameDirs) {
    for (const std::string &word : words) {
        const std::filesystem::path folder = GameFolderOfMap(word);
        const std::string gameDir = folder.filename().string();
        const auto isName = [&](const std::string &name) { return EqualNoCase(name, gameDir); };
        if (!folder.empty() && std::any_of(gameDirs.begin(), gameDirs.end(), isName))
            return folder.parent_path().string();
    }
    return {};
}

/// Names of the game folders in order of precedence: those of -fs_game, then the base game.
std::vector<std::string> GameDirs(const GlobalOptions &options) {
    std::vector<std::string> gameDirs = options.gameDirs;
    AddUnique(gameDirs, options.baseGame.value_or(std::string(options.game->gameDir)));
    return gameDirs;
}

std::string HomeRoot(const GlobalOptions &options) {
    const std::string homeBase = options.homeBase.value_or(std::string(options.game->homeDir));
    if (options.home) {
        const std::string home = WithSlashes(*options.home);
        if (homeBase == ".")
            return home;
        return home + "/" + (homeBase.starts_with('.') ? homeBase.substr(1) : homeBase);
    }
    return UserFolder(homeBase);
}

} // namespace

GlobalOptions ParseGlobalOptions(Arguments &arguments, Log &log) {
    GlobalOptions options;
    TakeSettings(GlobalSettings(), options, arguments, log);
    log.SetVerbose(options.verbose);
    ChooseGame(options, log);
    for (std::vector<std::string> *list :
         {&options.forbidden, &options.basePaths, &options.gameDirs, &options.pakPaths})
        Normalize(*list);
    return options;
}

std::vector<std::filesystem::path> BasePaths(const GlobalOptions &options, const std::vector<std::string> &arguments,
                                             const std::filesystem::path &program) {
    if (!options.basePaths.empty())
        return {options.basePaths.begin(), options.basePaths.end()};
    std::vector<std::string> words{program.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::string engine = EnginePathFrom(words, options.game->magic);
    if (engine.empty())
        engine = EnginePathOfMap(arguments, GameDirs(options));
    if (engine.empty())
        engine = program.parent_path().parent_path().string();
    if (engine.empty())
        throw Error("cannot tell where the game is installed; give it by -fs_basepath");
    return {engine};
}

std::vector<std::filesystem::path> GameFolders(const GlobalOptions &options, const std::vector<std::string> &arguments,
                                               const std::filesystem::path &program) {
    std::vector<std::string> roots;
    AddUnique(roots, HomeRoot(options));
    for (const std::filesystem::path &path : BasePaths(options, arguments, program))
        AddUnique(roots, path.string());
    std::vector<std::filesystem::path> folders;
    for (const std::string &gameDir : GameDirs(options))
        for (const std::string &root : roots)
            folders.push_back(std::filesystem::path(root) / gameDir);
    for (const std::string &path : options.pakPaths)
        folders.push_back(path);
    return folders;
}

std::filesystem::path GameFolderOfMap(const std::string &map) {
    std::error_code failed;
    const auto maps = std::filesystem::absolute(WithSlashes(map), failed).lexically_normal().parent_path();
    if (failed || !EqualNoCase(maps.filename().string(), "maps"))
        return {};
    return maps.parent_path();
}

VirtualFileSystem OpenGameFiles(const GlobalOptions &options, const std::vector<std::filesystem::path> &folders,
                                Log &log) {
    VirtualFileSystem vfs(log);
    vfs.SetForbidden(options.forbidden);
    for (const std::filesystem::path &folder : folders)
        vfs.Mount(folder, options.game->archiveExtension);
    return vfs;
}

} // namespace q3
