// GPL-2.0-or-later. Options of the stage -watch.
#include "q3map2/watch/options/watch_options.h"

#include "common/error.h"
#include "common/text/text.h"

#include <algorithm>
#include <array>

namespace q3 {

namespace {

constexpr int kMostPort = 65535;

/// Options with which a stage would not write the files that the page shows.
constexpr std::array<std::string_view, 10> kRefused{"-bspfile",   "-srffile", "-prtfile", "-linfile",  "-onlyents",
                                                    "-autocaulk", "-explain", "-part",    "-partfile", "-join"};

void RefuseOtherFiles(std::string_view name, const std::string &options) {
    for (const std::string &word : WordsOf(options))
        for (const std::string_view refused : kRefused)
            if (EqualNoCase(word, refused))
                throw Error("{} \"{}\": {} is not for -watch, which shows the .bsp next to the map", name, options,
                            refused);
}

} // namespace

std::vector<SettingGroup<WatchOptions>> WatchSettings() {
    constexpr SettingRange ports{0, kMostPort}, sizes{0, 16384};
    return {{"Stages",
             "OPTIONS is one word of the command line, so put it in quotes: `-lightoptions \"-fast -bounce 1\"`.",
             {{{.name = "-bspoptions",
                .values = "OPTIONS",
                .help = "Sets the options of the bsp stage",
                .since = "0.2.0",
                .example = "\"-meta -samplesize 8\""},
               &WatchOptions::bsp},
              {{.name = "-visoptions",
                .values = "OPTIONS",
                .help = "Sets the options of the vis stage that runs after the first picture",
                .details = "The vis stage before the first picture has `-fast`.",
                .since = "0.2.0",
                .example = "\"-fast\""},
               &WatchOptions::vis},
              {{.name = "-lightoptions",
                .values = "OPTIONS",
                .help = "Sets the options of the light stage that runs after the first picture",
                .since = "0.2.0",
                .example = "-fast"},
               &WatchOptions::light},
              {{.name = "-draftoptions",
                .values = "OPTIONS",
                .help = "Sets the options of the light stage that makes the first picture",
                .since = "0.2.0",
                .example = "\"-fast\""},
               &WatchOptions::draft}}},
            {"Page",
             "",
             {{{.name = "-port",
                .values = "N",
                .range = ports,
                .help = "Sets the port of the page, where 0 chooses a free one",
                .details = "The address of the page has a new random part in every run, whatever the port.",
                .since = "0.2.0",
                .example = "8027"},
               &WatchOptions::port},
              {{.name = "-texturesize",
                .values = "N",
                .unit = "texels",
                .range = sizes,
                .help = "Limits the longer side of textures to N, where 0 leaves all textures out",
                .since = "0.2.0",
                .example = "256"},
               &WatchOptions::textureSize},
              {{.name = "-open", .help = "Opens the page in the browser of the system", .since = "0.2.0"},
               &WatchOptions::open}}}};
}

WatchOptions ParseWatchOptions(Arguments &arguments, Log &log) {
    WatchOptions options;
    TakeSettings(WatchSettings(), options, arguments, log);
    RefuseOtherFiles("-bspoptions", options.bsp);
    RefuseOtherFiles("-visoptions", options.vis);
    RefuseOtherFiles("-lightoptions", options.light);
    RefuseOtherFiles("-draftoptions", options.draft);
    return options;
}

std::vector<std::string> WordsOf(const std::string &options) {
    std::vector<std::string> words;
    bool quoted = false, open = false;
    for (const char c : options) {
        if (c == '"') {
            quoted = !quoted;
            if (!open)
                words.emplace_back();
            open = true;
        } else if (!quoted && IsBlank(c)) {
            open = false;
        } else {
            if (!open)
                words.emplace_back();
            open = true;
            words.back() += c;
        }
    }
    return words;
}

} // namespace q3
