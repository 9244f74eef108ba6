// GPL-2.0-or-later. Checks that the game is known and its files exist.
#include "q3map2/game_check.h"

#include "common/error.h"
#include "common/nearest_names.h"
#include "common/text/text.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <iterator>

namespace q3 {

namespace {

namespace fs = std::filesystem;

bool IsFolder(const fs::path &path) {
    std::error_code absent;
    return fs::is_directory(path, absent);
}

bool HoldsGameFiles(const fs::path &folder, const Game &game) {
    const std::string archive = fmt::format(".{}", game.archiveExtension), packFolder = archive + "dir";
    std::error_code failed;
    for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed)) {
        const std::string name = LowerCase(at->path().filename().string());
        if (name.ends_with(archive) || name.ends_with(packFolder))
            return true;
        for (const std::string_view part : {game.shaderDir, std::string_view("textures"), std::string_view("models")})
            if (name == part && IsFolder(at->path()))
                return true;
    }
    return false;
}

std::string Joined(const std::vector<fs::path> &folders) {
    std::vector<std::string> names;
    for (const fs::path &folder : folders)
        names.push_back(folder.string());
    return fmt::format("{}", fmt::join(names, ", "));
}

/// The options to try if the map is in a game folder that the game does not search, such as baseoa in
/// DIR/baseoa/maps/x.map.
std::string HintOfMap(const std::vector<std::string> &words, const Game &game) {
    for (const std::string &word : words) {
        const fs::path folder = GameFolderOfMap(word);
        if (!folder.empty() && HoldsGameFiles(folder, game))
            return fmt::format("; the map is among the game files of {}: try -fs_basegame {}, or -fs_game {} for a mod",
                               folder.string(), folder.filename().string(), folder.filename().string());
    }
    return {};
}

void Report(bool force, std::string_view kind, std::string_view text, Log &log) {
    if (!force)
        throw Error("{}; -force goes on without", text);
    log.Warn(kind, "{}", text);
}

/// What someone may have meant who gives the name of a folder, or of a mod, for that of a game: the options to try.
std::string OptionsForFolder(std::string_view name) {
    struct OtherName {
        std::string_view name, options;
    };
    constexpr std::string_view kQuake = "-game quake3";
    constexpr auto kOthers = std::to_array<OtherName>({
        {"q3", kQuake},
        {"q3a", kQuake},
        {"quake3arena", kQuake},
        {"ioquake3", kQuake},
        {"quake3e", kQuake},
        {"oa", "-game quake3 -fs_basegame baseoa"},
        {"openarena", "-game quake3 -fs_basegame baseoa"},
        {"baseoa", "-game quake3 -fs_basegame baseoa, or -fs_game baseoa"},
        {"ta", "-game quake3 -fs_game missionpack"},
        {"teamarena", "-game quake3 -fs_game missionpack"},
        {"urt", "-game quake3 -fs_basegame q3ut4"},
        {"urbanterror", "-game quake3 -fs_basegame q3ut4"},
        {"q3ut4", "-game quake3 -fs_game q3ut4, or -fs_basegame q3ut4"},
        {"rtcw", "-game wolf"},
        {"etlegacy", "-game et"},
    });
    for (const OtherName &other : kOthers)
        if (EqualNoCase(other.name, name))
            return std::string(other.options);
    std::string options;
    for (const Game &game : Games())
        if (EqualNoCase(game.gameDir, name))
            options += fmt::format("{}-game {}", options.empty() ? "" : " or ", game.name);
    return options;
}

} // namespace

void ReportUnknownGame(std::string_view name, const GlobalOptions &options, Log &log) {
    std::vector<std::string> names;
    for (const Game &game : Games())
        names.emplace_back(game.name);
    std::string hint = DidYouMean(name, names);
    if (const std::string folder = OptionsForFolder(name); !folder.empty())
        hint = fmt::format("; try {}", folder);
    else if (hint.empty())
        hint = fmt::format("; if it is the folder of a mod, try -game quake3 -fs_game {}", name);
    if (!options.force)
        throw Error("-game {}: unknown{}{} -help game lists all; -force goes on with {}", name, hint,
                    hint.ends_with('?') ? "" : ";", options.game->name);
    log.Warn("unknown game", "-game {}: unknown, {} is used{}", name, options.game->name, hint);
}

void RequireGameFiles(const GlobalOptions &options, const std::vector<fs::path> &folders,
                      const std::vector<std::string> &words, Log &log) {
    const std::string_view base = options.baseGame ? std::string_view(*options.baseGame) : options.game->gameDir;
    const auto isGameDir = [](const fs::path &folder, const std::string &gameDir) {
        return folder.generic_string().ends_with("/" + gameDir);
    };
    for (const std::string &path : options.basePaths)
        if (!IsFolder(path))
            return Report(
                options.force, "no base path",
                fmt::format("no game files: -fs_basepath {} is not a folder; it must be the one that holds {} (searched: "
                            "{})",
                            path, base, Joined(folders)),
                log);
    for (const std::string &gameDir : options.gameDirs) {
        std::vector<fs::path> searched;
        std::copy_if(folders.begin(), folders.end(), std::back_inserter(searched),
                     [&](const fs::path &folder) { return isGameDir(folder, gameDir); });
        if (std::none_of(searched.begin(), searched.end(), IsFolder))
            return Report(options.force, "no mod folder",
                          fmt::format("-fs_game {}: no such folder; correct it or -fs_basepath (searched: {})", gameDir,
                                      Joined(searched)),
                          log);
    }
    if (std::none_of(folders.begin(), folders.end(),
                     [&](const fs::path &folder) { return HoldsGameFiles(folder, *options.game); }))
        Report(options.force, "no game files",
               fmt::format("no game files found; give the folder that holds {} by -fs_basepath (searched: {}){}", base,
                           Joined(folders), HintOfMap(words, *options.game)),
               log);
}

} // namespace q3
