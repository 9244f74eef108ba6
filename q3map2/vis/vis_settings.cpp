// GPL-2.0-or-later. The options of the vis stage, declared.
#include "q3map2/vis/vis_settings.h"

namespace q3 {

namespace {

/// A flag of VisOptions.
auto Vis(bool VisOptions::*field) {
    return [field](auto &o) -> auto & {
        return o.vis.*field;
    };
}

} // namespace

std::vector<SettingGroup<VisStageOptions>> VisSettings() {
    return {{"Visibility",
             "Of several modes the first one in this order counts: `-fast`, `-nopassage`, `-passageOnly`.",
             {{{.name = "-saveprt",
                .help = "Keep x.prt, which is deleted otherwise",
                .details = "It is deleted once the `.bsp` is written."},
               &VisStageOptions::savePrt},
              {{.name = "-fast",
                .help = "Rough visibility, quickly: only which way portals face decides",
                .details = "For test compiles: little is hidden, so the game runs slower."},
               Vis(&VisOptions::fast)},
              {{.name = "-merge",
                .help = "Merge leafs that are convex together, then their portals: quicker, less exact",
                .details = "Leafs are merged through hint portals too."},
               Vis(&VisOptions::merge)},
              {{.name = "-hint", .help = "As -merge, but leafs on both sides of a hint brush stay apart"},
               Vis(&VisOptions::keepHints)},
              {{.name = "-mergeportals", .help = "Merge portals between the same two leafs only"},
               Vis(&VisOptions::mergePortals)},
              {{.name = "-nopassage",
                .help = "Portal flow without passages: slower, less exact",
                .details = "Wins over `-passageOnly`."},
               Vis(&VisOptions::noPassage)},
              {{.name = "-passageOnly", .help = "Passages without portal flow: quicker, less exact"},
               Vis(&VisOptions::passageOnly)},
              {{.name = "-nosort", .help = "Process portals in the order of the file"}, Vis(&VisOptions::noSort)},
              {{.name = "-plain",
                .help = "Compute as the original q3map2 does, one portal after the other on one thread",
                .details = "Each direction is computed separately, and the lump is that of the original program."},
               Vis(&VisOptions::plain)},
              {{.name = "-v", .help = "A second -v: print how many clusters see how many others"},
               &VisStageOptions::histogram}}}};
}

} // namespace q3
