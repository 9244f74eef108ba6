// GPL-2.0-or-later. Declares the options that every stage accepts.
#include "q3map2/global_settings.h"

namespace q3 {

namespace {

using Group = SettingGroup<GlobalOptions>;

constexpr int kMaxThreads = 64, kMaxDrawSurfaces = 1 << 24;

Group General() {
    const auto help = [](GlobalOptions &o, const SettingValues &v) { o.help = v.words.empty() ? "" : v.words[0]; };
    return {
        "General",
        "They may stand anywhere on the line.",
        {{{.name = "-help",
           .aliases = {"--help", "-h"},
           .values = "[TOPIC]",
           .kind = SettingKind::Text,
           .help = "Print this overview, or what there is about a stage, an option, a key or a directive",
           .details = "Topics: a stage, an option, a key, a directive of shaders, `keys`, `shader` (all directives), "
                      "`vrad` (options of VRAD), `game` (the known games), and `all`. `markdown`, "
                      "`shadermarkdown`, `man`, `bash`, `zsh` and `fish` print this page, that of shader "
                      "directives, the manual page and shell completions."},
          Do<GlobalOptions>(help)},
         {{.name = "-version",
           .aliases = {"--version"},
           .help = "Print the version, commit, compiler, Embree version and SIMD level"},
          &GlobalOptions::version},
         {{.name = "-v",
           .firstOnly = true,
           .help = "Print more: every warning, scripts as they are read, counters",
           .details = "A second `-v` belongs to the vis stage."},
          &GlobalOptions::verbose},
         {{.name = "-threads",
           .values = "N",
           .initial = "one per hardware thread",
           .range = {0, kMaxThreads},
           .outside = OutOfRange::Clamp,
           .help = "Number of worker threads",
           .details = "The output does not depend on it."},
          &GlobalOptions::threads},
         {{.name = "-force",
           .help = "Go on without game files, and load files with another ident or version",
           .details = "Damaged lumps become warnings. So do what else keeps a stage from writing: an input that "
                      "changed meanwhile, a disk that seems too full, and a map that would lose most of its light "
                      "for want of its light entities."},
          &GlobalOptions::force},
         {{.name = "-log",
           .values = "FILE",
           .initial = "none",
           .help = "Write everything that is printed to a file too"},
          &GlobalOptions::logFile},
         {{.name = "-report",
           .values = "FILE.json",
           .initial = "none",
           .help = "Write settings, counts and times of each pass, and all warnings to a file",
           .details = "[report.md](report.md) describes it. A run that fails writes one too."},
          &GlobalOptions::reportFile},
         {{.name = "-connect",
           .values = "A.B.C.D:PORT",
           .initial = "none",
           .help = "Send everything that is printed to a level editor"},
          &GlobalOptions::connect}}};
}

Group BspStageOptions() {
    const auto drawSurfaces = [](GlobalOptions &o, const SettingValues &v) {
        o.maxDrawSurfaces = int(v.numbers[0] < 0 ? -v.numbers[0] : v.numbers[0]);
    };
    return {"Options of the bsp stage",
            "Accepted with every stage, since editors send them always.",
            {{{.name = "-subdivisions",
               .values = "N",
               .range = {.low = 1},
               .outside = OutOfRange::Clamp,
               .help = "bsp stage: tolerance of patches turned into triangles; smaller is finer"},
              &GlobalOptions::subdivisions},
             {{.name = "-maxmapdrawsurfs",
               .values = "N",
               .kind = SettingKind::Integer,
               .initial = "131072",
               .range = {-kMaxDrawSurfaces, kMaxDrawSurfaces},
               .help = "bsp stage: maximum number of draw surfaces while compiling",
               .details = "A negative number counts as its absolute value."},
              Do<GlobalOptions>(drawSurfaces)}}};
}

Group GamePaths() {
    const auto homePath = [](GlobalOptions &o, const SettingValues &v) {
        o.home = v.words[0];
        o.homeBase = ".";
    };
    return {"Game and folders",
            "Without `-fs_basepath` the first word of the command line, program path included, that contains the "
            "game's name (\"quake\") gives it: `/games/Quake3/baseq3/maps/x.bsp` means `/games/Quake3/`. Otherwise it "
            "is where the map is: a map in `baseq3/maps` of any folder, or in that of an `-fs_game`, means that "
            "folder. Failing that it is the folder above the program's. The bsp and light stages need the game's files "
            "and stop when an `-fs_basepath` is no folder, an `-fs_game` is nowhere, or no game folder holds an "
            "archive or one of the folders `scripts`, `textures` and `models`; an unknown `-game` is an error in all "
            "stages. With `-force` these are warnings; the light stage then knows of a shader what the shader records "
            "of the `.bsp` say.",
            {{{.name = "-game",
               .values = "NAME",
               .initial = "quake3",
               .help = "Game that the map is for; -help game lists them",
               .details = "Decides folder names, surfaceparms, file version and defaults of light."},
              &GlobalOptions::games},
             {{.name = "-fs_basepath",
               .values = "DIR",
               .initial = "by the path of the map or the program",
               .help = "Folder in which the game is installed; repeatable"},
              &GlobalOptions::basePaths},
             {{.name = "-fs_game",
               .values = "DIR",
               .initial = "none",
               .help = "Mod folder; repeatable, the first wins, and all win over the base game"},
              &GlobalOptions::gameDirs},
             {{.name = "-fs_basegame", .values = "DIR", .initial = "by game", .help = "Folder of the base game"},
              &GlobalOptions::baseGame},
             {{.name = "-fs_home",
               .values = "DIR",
               .initial = "home of the user",
               .help = "Folder that holds the folder with the user's own files"},
              &GlobalOptions::home},
             {{.name = "-fs_homebase",
               .values = "DIR",
               .initial = "by game",
               .help = "Name of the folder with the user's own files, such as .q3a; its dot is dropped with -fs_home"},
              &GlobalOptions::homeBase},
             {{.name = "-fs_homepath",
               .values = "DIR",
               .kind = SettingKind::Text,
               .initial = "none",
               .help = "Path of the folder with the user's own files, in place of -fs_home and -fs_homebase"},
              Do<GlobalOptions>(homePath)},
             {{.name = "-fs_pakpath",
               .values = "DIR",
               .initial = "none",
               .help = "One more folder with game files, searched last; repeatable"},
              &GlobalOptions::pakPaths},
             {{.name = "-fs_forbiddenpath",
               .values = "MASK",
               .initial = "none",
               .help = "Skip folders and archives of that name, with ? and *; repeatable"},
              &GlobalOptions::forbidden}}};
}

} // namespace

std::vector<SettingGroup<GlobalOptions>> GlobalSettings() {
    return {General(), BspStageOptions(), GamePaths()};
}

} // namespace q3
