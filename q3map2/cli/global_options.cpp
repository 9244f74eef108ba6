// GPL-2.0-or-later. Options that every stage accepts, and the game and its files that they select.
#include "q3map2/cli/global_options.h"

#include "common/error.h"
#include "common/files/dependencies.h"
#include "common/files/files.h"
#include "common/platform/platform.h"
#include "common/text/text.h"
#include "q3map2/bspfile/entities.h"

#include <fmt/ranges.h>
#include <glib.h>

#include <algorithm>
#include <array>
#include <iterator>

namespace q3 {

// ---- The game and its files, from the options ----

namespace {

std::string WithSlashes(std::string path) {
    std::replace(path.begin(), path.end(), '\\', '/');
    return path;
}

/// Adds the value, with slashes instead of backslashes, unless the list has it in any case.
void AddUnique(std::vector<std::string> &list, std::string value) {
    value = WithSlashes(std::move(value));
    if (std::none_of(list.begin(), list.end(), [&](const std::string &known) { return EqualNoCase(known, value); }))
        list.push_back(std::move(value));
}

/// Makes each path AddUnique to the others, in their order.
void TidyPaths(std::vector<std::string> &list) {
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

/// The engine path that the program's path, a word of the command line or the folder of the map tells. Empty: none.
std::string EnginePathOfWords(const GlobalOptions &options, const std::vector<std::string> &arguments,
                              const std::filesystem::path &program) {
    std::vector<std::string> words{program.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::string engine = EnginePathFrom(words, options.game->magic);
    return engine.empty() ? EnginePathOfMap(arguments, GameDirs(options)) : engine;
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
        TidyPaths(*list);
    if (options.noHomePath && (options.home || options.homeBase))
        log.Warn("home path",
                 "-fs_nohomepath: the folder with the user's own files is not searched, although {} is "
                 "given",
                 options.home ? "-fs_home or -fs_homepath" : "-fs_homebase");
    return options;
}

std::vector<std::string> GlobalWords(const std::vector<std::string> &words, std::span<const std::string_view> without) {
    const std::vector<SettingSection> sections = GlobalSections();
    const auto find = [&](const std::string &word) -> const SettingInfo * {
        for (const SettingSection &section : sections)
            for (const SettingEntry &entry : section.entries)
                if (entry.info.Names(word))
                    return &entry.info;
        return nullptr;
    };
    std::vector<std::string> kept;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const SettingInfo *const info = find(words[i]);
        if (!info)
            continue;
        const std::size_t end = std::min(i + 1 + info->MinValues(), words.size());
        if (std::none_of(without.begin(), without.end(), [&](std::string_view name) { return info->Names(name); }))
            kept.insert(kept.end(), words.begin() + std::ptrdiff_t(i), words.begin() + std::ptrdiff_t(end));
        i = end - 1;
    }
    return kept;
}

std::vector<std::filesystem::path> BasePaths(const GlobalOptions &options, const std::vector<std::string> &arguments,
                                             const std::filesystem::path &program) {
    if (!options.basePaths.empty())
        return {options.basePaths.begin(), options.basePaths.end()};
    if (options.noBasePath)
        return {};
    std::string engine = options.noMagicPath ? std::string() : EnginePathOfWords(options, arguments, program);
    if (engine.empty())
        engine = program.parent_path().parent_path().string();
    if (engine.empty())
        throw Error("cannot find the folder of the game; name it with -fs_basepath");
    return {engine};
}

std::vector<std::filesystem::path> GameFolders(const GlobalOptions &options, const std::vector<std::string> &arguments,
                                               const std::filesystem::path &program) {
    std::vector<std::string> roots;
    if (!options.noHomePath)
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

namespace {

/// Packages as folders that maps named on the command line are in, the first last.
std::vector<std::filesystem::path> PackagesOfMaps(const std::vector<std::string> &words) {
    std::vector<std::filesystem::path> packages;
    for (const std::string &word : words) {
        std::filesystem::path folder = GameFolderOfMap(word);
        std::error_code absent;
        const bool isPackage = EqualNoCase(folder.extension().string(), kPackageFolderExtension) ||
                               std::filesystem::is_regular_file(folder / kDependencyFile, absent);
        if (!folder.empty() && isPackage && std::ranges::find(packages, folder) == packages.end())
            packages.insert(packages.begin(), std::move(folder));
    }
    return packages;
}

} // namespace

VirtualFileSystem OpenGameFiles(const GlobalOptions &options, const std::vector<std::filesystem::path> &folders,
                                Log &log, const std::vector<std::string> &words) {
    VirtualFileSystem vfs(log);
    vfs.SetForbidden(options.forbidden);
    for (const std::filesystem::path &folder : folders)
        vfs.Mount(folder, options.game->archiveExtension);
    if (options.game->archiveExtension == kPackageExtension.substr(1))
        for (const std::filesystem::path &package : PackagesOfMaps(words))
            vfs.PreferDependencies(package);
    return vfs;
}

// ---- Options declared: name, range, default, help ----

namespace {

using Group = SettingGroup<GlobalOptions>;

constexpr int kMaxDrawSurfaces = 1 << 24; ///< limit of this program, chosen

Group General() {
    const auto help = [](GlobalOptions &o, const SettingValues &v) { o.help = v.words.empty() ? "" : v.words[0]; };
    return {
        "General",
        "These options may be anywhere on the line.",
        {{{.name = "-help",
           .aliases = {"--help", "-h"},
           .values = "[TOPIC]",
           .kind = SettingKind::Text,
           .initial = "an overview",
           .help = "Prints an overview, or what there is about a stage, an option, a key or a directive",
           .details = "TOPIC is the name of a stage, an option, a key of entities or a directive of shaders. It "
                      "may also be `keys` (all keys), `shader` (all directives), `vrad` (options of VRAD), `game` "
                      "(the known games) or `all`. The topics `light.md` and so on, `man`, `bash`, `zsh` and "
                      "`fish` print pages of the reference, the manual page and shell completions.",
           .since = "q3map2",
           .example = "samples"},
          Do<GlobalOptions>(help)},
         {{.name = "-version",
           .aliases = {"--version"},
           .help = "Prints the version, commit, compiler, Embree version and SIMD level",
           .since = "0.1.0"},
          &GlobalOptions::version},
         {{.name = "-v",
           .firstOnly = true,
           .help = "Prints more: every warning, scripts as they are read, and counters",
           .details = "A second `-v` belongs to the vis stage. `-light` and `-vis` end with a table of [which work is "
                      "parallel](../internals/scaling.md#many-cores).",
           .since = "q3map2"},
          &GlobalOptions::verbose},
         {{.name = "-cache",
           .values = "DIR",
           .initial = "none",
           .help = "Keeps results of the bsp, vis and light stages in a folder, and does not compute them again",
           .details = "A stage whose inputs are unchanged gives the files and warnings of the earlier run. The light "
                      "stage computes direct light again only where lights changed. The files have the same bytes as "
                      "without this option. The word `default` as DIR means `q3map2-sh` in the folder for caches of "
                      "the user. Other stages ignore the option. See [the cache](../guide/cache.md).",
           .since = "0.2.0",
           .example = "default"},
          &GlobalOptions::cache},
         {{.name = "-cachesize",
           .values = "N",
           .unit = "MB",
           .range = {.low = 16},
           .help = "Limits the folder of -cache; results that were not used for the longest time are removed first",
           .since = "0.2.0",
           .example = "8192"},
          &GlobalOptions::cacheSize},
         {{.name = "-threads",
           .values = "N",
           .initial = "one per hardware thread",
           .range = {0, kMaxThreads},
           .outside = OutOfRange::Clamp,
           .help = "Sets the number of worker threads",
           .details = "The output does not depend on it.",
           .since = "q3map2",
           .example = "4"},
          &GlobalOptions::threads},
         {{.name = "-force",
           .help = "Continues without game files, and loads files with another ident or version",
           .details = "Errors about damaged lumps become warnings. So do errors about an input that changed "
                      "meanwhile, a disk that seems too full, and a map that would lose most of its light because "
                      "its light entities are missing.",
           .since = "q3map2"},
          &GlobalOptions::force},
         {{.name = "-log",
           .values = "FILE",
           .initial = "none",
           .help = "Writes everything that is printed to a file too",
           .since = "0.2.0",
           .example = "mymap.log"},
          &GlobalOptions::logFile},
         {{.name = "-report",
           .values = "FILE.json",
           .initial = "none",
           .help = "Writes the settings, the counts and times of each pass, and all warnings to a file",
           .details = "The page [The report of a run](report.md) describes the file. A run that fails writes one too.",
           .since = "0.2.0",
           .example = "mymap.json"},
          &GlobalOptions::reportFile},
         {{.name = "-connect",
           .values = "A.B.C.D:PORT",
           .initial = "none",
           .help = "Sends everything that is printed to a level editor",
           .since = "q3map2",
           .example = "127.0.0.1:39000"},
          &GlobalOptions::connect}}};
}

Group BspStageOptions() {
    const auto drawSurfaces = [](GlobalOptions &o, const SettingValues &v) {
        o.maxDrawSurfaces = int(v.numbers[0] < 0 ? -v.numbers[0] : v.numbers[0]);
    };
    return {"Options of the bsp stage",
            "Every stage accepts these options, since editors always send them.",
            {{{.name = "-subdivisions",
               .values = "N",
               .range = {.low = 1},
               .outside = OutOfRange::Clamp,
               .help = "Sets the tolerance of patches that the bsp stage turns into triangles, where smaller is finer",
               .since = "q3map2",
               .example = "4"},
              &GlobalOptions::subdivisions},
             {{.name = "-maxmapdrawsurfs",
               .values = "N",
               .kind = SettingKind::Integer,
               .initial = "131072",
               .range = {-kMaxDrawSurfaces, kMaxDrawSurfaces},
               .help = "Sets the largest number of draw surfaces while the bsp stage compiles",
               .details = "A negative number counts as its absolute value.",
               .since = "q3map2",
               .example = "262144"},
              Do<GlobalOptions>(drawSurfaces)}}};
}

Group GamePaths() {
    const auto homePath = [](GlobalOptions &o, const SettingValues &v) {
        o.home = v.words[0];
        o.homeBase = ".";
    };
    return {
        "Game and folders",
        "The option `-fs_basepath` names the folder of the game. Without it, the first word of the command line, "
        "program path included, that contains the name of the game (\"quake\") gives it. So "
        "`/games/Quake3/baseq3/maps/x.bsp` means `/games/Quake3/`. Otherwise the folder follows from the map: a map in "
        "`baseq3/maps` of a folder, or in the `maps` of an `-fs_game` in it, means that folder. Failing that, it is "
        "the "
        "folder above that of the program. With `-fs_nomagicpath` only the last of these is tried, and with "
        "`-fs_nobasepath` none of them. With `-fs_nohomepath` in addition, only the folders of `-fs_basepath` and "
        "`-fs_pakpath` are searched. The bsp and light stages need the files of the game. They stop if an "
        "`-fs_basepath` is not a folder, if an `-fs_game` does not exist, or if no game folder holds an archive, "
        "shader scripts, `textures` or `models`. An unknown `-game` is an error in all stages. With `-force` these "
        "errors are warnings, and the light stage then knows only what the `.bsp` says about shaders.",
        {{{.name = "-game",
           .values = "NAME",
           .initial = "quake3",
           .help = "Chooses the game that the map is for, which -help game lists",
           .details = "It decides the names of folders, the surfaceparms, the file version and the defaults of light.",
           .since = "q3map2",
           .example = "xonotic"},
          &GlobalOptions::games},
         {{.name = "-fs_basepath",
           .values = "DIR",
           .initial = "by the path of the map or the program",
           .help = "Names the folder in which the game is installed",
           .details = "It may be given several times.",
           .since = "q3map2",
           .example = "/games/quake3"},
          &GlobalOptions::basePaths},
         {{.name = "-fs_game",
           .values = "DIR",
           .initial = "none",
           .help = "Names the folder of a mod, whose files override those of the base game",
           .details = "It may be given several times, and then the first one overrides the others.",
           .since = "q3map2",
           .example = "missionpack"},
          &GlobalOptions::gameDirs},
         {{.name = "-fs_basegame",
           .values = "DIR",
           .initial = "by game",
           .help = "Names the folder of the base game",
           .since = "q3map2",
           .example = "baseoa"},
          &GlobalOptions::baseGame},
         {{.name = "-fs_home",
           .values = "DIR",
           .initial = "home of the user",
           .help = "Names the folder that holds the folder with the user's own files",
           .since = "q3map2",
           .example = "/home/mapper"},
          &GlobalOptions::home},
         {{.name = "-fs_homebase",
           .values = "DIR",
           .initial = "by game",
           .help = "Names the folder with the user's own files, such as .q3a",
           .details = "With `-fs_home` the dot in front of the name is dropped.",
           .since = "q3map2",
           .example = ".openarena"},
          &GlobalOptions::homeBase},
         {{.name = "-fs_homepath",
           .values = "DIR",
           .kind = SettingKind::Text,
           .initial = "none",
           .help = "Sets the path of the folder with the user's own files",
           .details = "It is used instead of `-fs_home` and `-fs_homebase`.",
           .since = "q3map2",
           .example = "/home/mapper/.q3a"},
          Do<GlobalOptions>(homePath)},
         {{.name = "-fs_nobasepath",
           .help = "Uses no base paths except those of -fs_basepath",
           .details = "Implies `-fs_nomagicpath`.",
           .since = "q3map2"},
          &GlobalOptions::noBasePath},
         {{.name = "-fs_nohomepath", .help = "Does not search the folder with the user's own files", .since = "q3map2"},
          &GlobalOptions::noHomePath},
         {{.name = "-fs_nomagicpath",
           .help = "Does not take the path of the game from words of the command line",
           .since = "q3map2"},
          &GlobalOptions::noMagicPath},
         {{.name = "-fs_pakpath",
           .values = "DIR",
           .initial = "none",
           .help = "Adds a folder with game files, which is searched last",
           .details = "It may be given several times.",
           .since = "q3map2",
           .example = "/games/texturepacks"},
          &GlobalOptions::pakPaths},
         {{.name = "-fs_forbiddenpath",
           .values = "MASK",
           .initial = "none",
           .help = "Skips folders and archives of that name, which may contain ? and *",
           .details = "It may be given several times.",
           .since = "q3map2",
           .example = "'old*.pk3'"},
          &GlobalOptions::forbidden}}};
}

} // namespace

std::vector<SettingGroup<GlobalOptions>> GlobalSettings() {
    return {General(), BspStageOptions(), GamePaths()};
}

std::vector<SettingSection> GlobalSections() {
    return Describe(GlobalSettings());
}

// ---- Checks that the game is known and its files exist ----

namespace {

namespace fs = std::filesystem;

bool IsFolder(const fs::path &path) {
    std::error_code absent;
    return fs::is_directory(path, absent);
}

bool HoldsGameFiles(const fs::path &folder, const Game &game) {
    const std::string archive = fmt::format(".{}", game.archiveExtension), packFolder = archive + "dir";
    for (const fs::path &entry : EntriesOf(folder)) {
        const std::string name = LowerCase(entry.filename().string());
        if (name.ends_with(archive) || name.ends_with(packFolder))
            return true;
        for (const std::string_view part : {game.shaderDir, std::string_view("textures"), std::string_view("models")})
            if (name == part && IsFolder(entry))
                return true;
    }
    return false;
}

std::string Joined(const std::vector<fs::path> &folders) {
    std::vector<std::string> names;
    for (const fs::path &folder : folders)
        names.push_back(folder.string());
    return names.empty() ? "nothing" : fmt::format("{}", fmt::join(names, ", "));
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

/// Error, or a warning with -force.
void FailOrWarn(bool force, std::string_view kind, std::string_view text, Log &log) {
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
        {"warsow", "-game qfusion -fs_basegame basewsw"},
        {"basewsw", "-game qfusion -fs_basegame basewsw"},
        {"warfork", "-game qfusion -fs_basegame basewf"},
        {"basewf", "-game qfusion -fs_basegame basewf"},
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
            return FailOrWarn(
                options.force, "no base path",
                fmt::format(
                    "no game files: {} is not a folder; -fs_basepath must name the folder that contains {} (searched: "
                    "{})",
                    path, base, Joined(folders)),
                log);
    for (const std::string &gameDir : options.gameDirs) {
        std::vector<fs::path> searched;
        std::copy_if(folders.begin(), folders.end(), std::back_inserter(searched),
                     [&](const fs::path &folder) { return isGameDir(folder, gameDir); });
        if (std::none_of(searched.begin(), searched.end(), IsFolder))
            return FailOrWarn(options.force, "no mod folder",
                              fmt::format("-fs_game {}: no such folder; correct it or -fs_basepath (searched: {})",
                                          gameDir, Joined(searched)),
                              log);
    }
    if (std::none_of(folders.begin(), folders.end(),
                     [&](const fs::path &folder) { return HoldsGameFiles(folder, *options.game); }))
        FailOrWarn(options.force, "no game files",
                   fmt::format("no game files found; give the folder that holds {} by -fs_basepath (searched: {}){}",
                               base, Joined(folders), HintOfMap(words, *options.game)),
                   log);
}

} // namespace q3
