// GPL-2.0-or-later. Options of -pk3 and -repack.
#include "q3map2/pk3/package_options.h"

namespace q3 {

namespace {

constexpr int kLeastLevel = -1, kMostLevel = 10;

template <typename Options> SettingGroup<Options> PackingGroup() {
    return {"Packing",
            "",
            {{{.name = "-dbg", .help = "Print what was collected: shaders, sounds, models, scripts, images"},
              &Options::list},
             {{.name = "-png",
               .help = "Take images in PNG too, before TGA and JPEG",
               .details = "The engine of Quake III Arena does not read them; many later ones do."},
              &Options::png},
             {{.name = "-complevel",
               .values = "N",
               .range = {kLeastLevel, kMostLevel},
               .help = "Compression: 0 none, 1 fast, 9 small, -1 as zlib chooses; 10 is 9"},
              &Options::level},
             {{.name = "-outdir",
               .values = "DIR",
               .initial = "first base path",
               .help = "Folder in which the package is written"},
              &Options::folder},
             {{.name = "-basepak",
               .values = "MASK",
               .initial = "none",
               .help = "Leave out what archives of that name hold, with ? and *; repeatable",
               .details = "For archives that every player has: `-basepak 'pak?.pk3'`."},
              &Options::basePaks},
             {{.name = "-exclude",
               .values = "FILE",
               .initial = "GAME.exclude beside the program",
               .help = "One more file that lists what is left out; repeatable",
               .details = "[package.md](package.md#leaving-files-out) describes it."},
              &Options::exclusions}}};
}

} // namespace

std::vector<SettingGroup<PackOptions>> PackSettings() {
    return {PackingGroup<PackOptions>()};
}

std::vector<SettingGroup<RepackOptions>> RepackSettings() {
    SettingGroup<RepackOptions> group = PackingGroup<RepackOptions>();
    group.settings.push_back(
        {{.name = "-analyze", .help = "Print what was collected, and write nothing"}, &RepackOptions::onlyList});
    return {group};
}

} // namespace q3
