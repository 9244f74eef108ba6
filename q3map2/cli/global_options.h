// GPL-2.0-or-later. Options that every stage accepts, and the game and its files that they select.
#pragma once

#include "common/arguments.h"
#include "common/files/vfs.h"
#include "common/jobs.h"
#include "common/log.h"
#include "common/settings.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/map/bsp_options.h"
#include "q3map2/shader/games.h"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Declared in global_options.cpp.
struct GlobalOptions {
    const Game *game = nullptr;
    bool verbose = false;
    bool force = false;                           ///< some errors are only warnings: the help of -force says which
    bool version = false;                         ///< print the version, and nothing else
    int threads = 0;                              ///< 0: one per hardware thread
    int subdivisions = BspOptions{}.subdivisions; ///< of the bsp stage
    int maxDrawSurfaces = BspOptions{}.maxDrawSurfaces; ///< of the bsp stage
    std::string cache;                                  ///< folder of results of earlier runs; empty: none
    int cacheSize = 2048;                               ///< limit of that folder, MB
    std::string logFile;                                ///< empty: none
    std::string reportFile;                             ///< empty: none
    std::string connect;                                ///< address of the editor, empty without one
    std::optional<std::string> help;                    ///< topic, possibly empty
    std::vector<std::string> games;                     ///< every -game, in order
    std::vector<std::string> basePaths;                 ///< every -fs_basepath
    std::vector<std::string> gameDirs;                  ///< every -fs_game, the first wins
    std::vector<std::string> pakPaths;                  ///< every -fs_pakpath
    std::vector<std::string> forbidden;                 ///< masks of folders and archives to skip: -fs_forbiddenpath
    std::optional<std::string> baseGame;                ///< folder of the base game; unset: that of `game`
    std::optional<std::string> home;                    ///< folder that holds the user's files; unset: by the system
    std::optional<std::string> homeBase;                ///< name of the user's folder in `home`; unset: that of `game`
    bool noBasePath = false;  ///< -fs_nobasepath: without -fs_basepath there is no base path at all
    bool noHomePath = false;  ///< -fs_nohomepath: the user's own files are not searched
    bool noMagicPath = false; ///< -fs_nomagicpath: words of the command line do not tell the base path

    BspFormat Format() const {
        return {.version = game->bspVersion,
                .advertisements = game->hasAdvertisements,
                .force = force,
                .ident = game->bspIdent,
                .lightmapSide = game->bspIdent == kIbspIdent ? game->lightmapSize : kLightmapSide};
    }
};

/// Takes the global options off `arguments`. Errors: those of TakeSettings, and an unknown -game, which is a warning
/// with -force.
GlobalOptions ParseGlobalOptions(Arguments &arguments, Log &log);

/// The global options among the words of a command line with their values, in order, but for those named `without`.
std::vector<std::string> GlobalWords(const std::vector<std::string> &words, std::span<const std::string_view> without);

/// The folders of -fs_basepath, or the one folder in which the game seems to be installed: see GameFolders. None with
/// -fs_nobasepath alone.
std::vector<std::filesystem::path> BasePaths(const GlobalOptions &options, const std::vector<std::string> &arguments,
                                             const std::filesystem::path &program);

/// Game folders by descending priority: mods before the base game, home before base paths, -fs_pakpath last.
/// `arguments` are searched for the engine path when no -fs_basepath is given.
std::vector<std::filesystem::path> GameFolders(const GlobalOptions &options, const std::vector<std::string> &arguments,
                                               const std::filesystem::path &program);

/// The game folder that a map is in: DIR/game of DIR/game/maps/x.map. Empty: the map is not in a folder called maps.
std::filesystem::path GameFolderOfMap(const std::string &map);

/// Mounts the folders. For games whose archives are .dpk packages those come first that the package of a map in
/// `words`, the command line, is in, and that it needs.
VirtualFileSystem OpenGameFiles(const GlobalOptions &options, const std::vector<std::filesystem::path> &folders,
                                Log &log, const std::vector<std::string> &words = {});

// ---- The options that every stage accepts, declared ----

std::vector<SettingGroup<GlobalOptions>> GlobalSettings();
/// The same, described for help and documentation.
std::vector<SettingSection> GlobalSections();

/// Error (with -force a warning) that -game names no game of the table, with the nearest names.
void ReportUnknownGame(std::string_view name, const GlobalOptions &options, Log &log);

/// For stages that read shaders and images. Error (with -force a warning), naming the folders searched and the option
/// to change, when an -fs_basepath is no folder, an -fs_game is in none of the roots, or no game folder holds game
/// files: an archive, or one of the folders scripts, textures and models. `folders`: from GameFolders; `words`: the
/// command line, whose map may tell where the game is.
void RequireGameFiles(const GlobalOptions &options, const std::vector<std::filesystem::path> &folders,
                      const std::vector<std::string> &words, Log &log);

} // namespace q3
