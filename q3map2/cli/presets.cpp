// GPL-2.0-or-later. Options that stand for others: named sets of options (-preset), and the options of VRAD.
#include "q3map2/cli/presets.h"

#include "common/error.h"
#include "common/text/text.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <sstream>

namespace q3 {

// ---- Named sets of options ----

namespace {

// docs/guide/releasing.md has error and size of these SH grids.
constexpr std::array<Preset, 3> kPresets{{
    {.name = "draft",
     .help = "Shows quickly what a change does",
     .bsp = "-meta -samplesize 32",
     .vis = "-fast",
     .light = "-faster",
     .gridSH = "-gridsh 64 64 128"},
    {.name = "normal",
     .help = "Lights play tests, with soft shadows and two bounces",
     .bsp = "-meta",
     .vis = "",
     .light = "-fast -areashadows 64 -samples 2 -bounce 2 -bouncegrid",
     .gridSH = "-gridsh 64 64 64"},
    {.name = "final",
     .help = "Lights the release: nothing is left out for speed, and the SH grid is small and fitted",
     .bsp = "-meta",
     .vis = "",
     .light = "-patchshadows -areashadows -samples 3 -bounce inf -bouncegrid",
     .gridSH = "-gridsh 64 64 64 -shfit"},
}};

std::string_view OptionsOf(const Preset &preset, std::string_view stage) {
    return stage == "-bsp" ? preset.bsp : stage == "-vis" ? preset.vis : preset.light;
}

bool HasPresets(std::string_view stage) {
    return stage == "-bsp" || stage == "-vis" || stage == "-light";
}

bool HasWord(const std::vector<std::string> &words, std::string_view option) {
    return std::ranges::any_of(words, [&](const std::string &word) { return EqualNoCase(word, option); });
}

/// Whether the line asks for an SH grid and leaves the size of its cells to the preset. Grids that name lights cannot
/// be fitted, so they keep their own cells.
bool TakesGridSH(const std::vector<std::string> &words) {
    constexpr std::string_view kGridOptions[] = {"-sh",       "-shbspx",        "-shradiance", "-shadaptive",
                                                 "-shbudget", "-sherrortarget", "-gridformats"};
    return !HasWord(words, "-shsmall") && !HasWord(words, "-shlights") &&
           std::ranges::any_of(kGridOptions, [&](std::string_view option) { return HasWord(words, option); });
}

const Preset &FindPreset(std::string_view name) {
    const auto found =
        std::ranges::find_if(kPresets, [&](const Preset &preset) { return EqualNoCase(preset.name, name); });
    if (found != kPresets.end())
        return *found;
    std::vector<std::string> names;
    for (const Preset &preset : kPresets)
        names.emplace_back(preset.name);
    throw Error("-preset {}: expected one of {}{}", name, fmt::join(names, ", "), DidYouMean(name, names));
}

} // namespace

std::span<const Preset> Presets() {
    return kPresets;
}

void ExpandPreset(const Stage &stage, Arguments &arguments, Log &log) {
    if (!HasPresets(stage.word))
        return;
    const auto name = arguments.TakeValue("-preset");
    if (!name)
        return;
    if (arguments.TakeValue("-preset"))
        throw Error("-preset: expected once, found twice");
    const Preset &preset = FindPreset(*name);
    std::string options(OptionsOf(preset, stage.word));
    if (stage.word == "-light" && TakesGridSH(arguments.Rest()))
        options += fmt::format(" {}", preset.gridSH);
    log.Print("preset {}: {}\n", preset.name, options.empty() ? "no options" : options);
    std::istringstream text(options);
    std::vector<std::string> words;
    for (std::string word; text >> word;)
        words.push_back(word);
    arguments.Prepend(words);
}

SettingSection PresetSection() {
    static const std::string details = [] {
        const auto named = [](std::string_view options) {
            return options.empty() ? std::string("no options") : fmt::format("`{}`", options);
        };
        std::string text = "Options on the line are added to the set and override it. The run prints the set. ";
        for (const Preset &preset : kPresets)
            text += fmt::format(
                "The preset `{}` stands for {} in the bsp stage, {} in the vis stage and {} in the light "
                "stage. If the line asks for an SH grid, {} is added. ",
                preset.name, named(preset.bsp), named(preset.vis), named(preset.light), named(preset.gridSH));
        return text + "[Releasing](../guide/releasing.md) compares their results and times.";
    }();
    const SettingInfo info{.name = "-preset",
                           .values = "draft|normal|final",
                           .kind = SettingKind::Choice,
                           .help = "Selects a set of options for a quick look, for play tests or for the release",
                           .details = details,
                           .since = "0.2.0",
                           .example = "final"};
    return {"Preset", "", {{info, "none"}}};
}

// ---- Options of VRAD ----

namespace {

constexpr std::string_view kPerLuxel =
    "radiosity is solved per luxel, so use -samplesize and -bouncerays for its quality";

/// The advice about options with a replacement says what that is. Other advice is a clause.
constexpr VradOption kVradOptions[] = {
    {"-final", "", "", "-preset final", "the preset for the release"},
    {"-extra", "", "", "-samples 2", "adaptive samples at shadow edges"},
    {"-noextra", "", "", "-samples 1", "one sample per luxel"},
    {"-fastambient", "", "", "-cubesperleaf 1", "one ambient cube per leaf"},
    {"-smooth", "N", "45", "-shade -shadeangle N", "smooth shading of edges up to that angle"},
    {"-reflectivityscale", "N", "0.8", "-bouncescale N", "a factor of bounced light"},
    {"-chop", "N", "4", "", kPerLuxel},
    {"-maxchop", "N", "4", "", kPerLuxel},
    {"-dispchop", "N", "8", "", kPerLuxel},
    {"-maxdispchop", "N", "64", "", kPerLuxel},
    {"-choptexlights", "N", "64", "", "use q3map_lightSubdivide, which divides surface lights"},
    {"-softsun", "N", "5", "", "use SunSpreadAngle of light_environment, or the deviance of q3map_sunExt"},
    {"-extrasky", "N", "16", "", "use _samples of light_environment, or the iterations of q3map_skylight"},
    {"-extrapasses", "N", "4", "", "use -samples N"},
    {"-luxeldensity", "N", "0.5", "", "use -samplescale N, where 2 halves the density"},
    {"-centersamples", "", "", "", "samples are always at the centers of luxels"},
    {"-ambient", "R G B", "10 10 10", "", "use the worldspawn key _ambient"},
    {"-maxlight", "N", "200", "", "use the worldspawn key _maxlight"},
    {"-dlight", "N", "0.1", "", "surface lights always reach as far as their light lasts"},
    {"-noskyboxrecurse", "", "", "", "rays always end at the sky"},
    {"-nodetaillight", "", "", "", "q3map2-sh has no detail props"},
    {"-onlydetail", "", "", "", "q3map2-sh has no detail props"},
    {"-nossprops", "", "", "", "props cast the shadows of their triangles only with -staticproppolys"},
    {"-staticpropnormals", "", "", "", "use -debugnormals, which shows the normals of luxels"},
    {"-dumpnormals", "", "", "", "use -debugnormals, which shows the normals of luxels"},
    {"-debugextra", "", "", "", "use -debug, which marks luxels that were filled"},
    {"-rederrors", "", "", "", "use -debug, which marks luxels that were filled"},
    {"-low", "", "", "", "set the priority of the process with the system, by nice or start /low"},
    {"-mpi", "", "", "", "one machine does all the work, with -threads N"},
    {"-mpi_pw", "PASSWORD", "secret", "", "one machine does all the work, with -threads N"},
    {"-vproject", "DIR", "/games/quake3", "", "use -fs_basepath DIR and -fs_game NAME"},
    {"-insert_search_path", "DIR", "/games/quake3", "", "use -fs_basepath, which can be repeated"},
    {"-novconfig", "", "", "", "q3map2-sh has no such window"},
    {"-stoponexit", "", "", "", "the program never waits for a key"},
    {"-compressconstant", "", "", "", "lightmaps of one color are always stored as one texel"},
    {"-loghash", "", "", "", "use -v to print details, and -report to write them as JSON"},
    {"-verbose", "", "", "", "use -v to print details"},
};

std::string VradHelp(const VradOption &option) {
    if (!option.replacement.empty())
        return fmt::format("Becomes `{}`, {}", option.replacement, option.advice);
    std::string advice(option.advice);
    if (advice[0] >= 'a' && advice[0] <= 'z' && !advice.starts_with("q3map2"))
        advice[0] = char(advice[0] - 'a' + 'A');
    return fmt::format("Does nothing. {}", advice);
}

std::vector<std::string> ReplacementWords(const VradOption &option, const std::string &value) {
    std::istringstream text{std::string(option.replacement)};
    std::vector<std::string> words;
    for (std::string word; text >> word;)
        words.push_back(word == "N" ? value : word);
    return words;
}

} // namespace

std::span<const VradOption> VradOptions() {
    return kVradOptions;
}

void TranslateVradOptions(const Stage &stage, Arguments &arguments, Log &log) {
    if (stage.word != "-light")
        return;
    for (const VradOption &option : kVradOptions)
        while (const auto values = arguments.TakeValues({option.name}, option.Info().MinValues())) {
            if (option.replacement.empty()) {
                log.Warn(option.name, "{} is an option of VRAD without an effect in q3map2-sh: {}", option.name,
                         option.advice);
                continue;
            }
            const auto words = ReplacementWords(option, values->empty() ? std::string() : values->front());
            log.Print("{} of VRAD: {} ({})\n", option.name, fmt::join(words, " "), option.advice);
            arguments.Prepend(words);
        }
}

SettingSection VradSection() {
    static const std::vector<std::string> helps = [] {
        std::vector<std::string> texts;
        for (const VradOption &option : kVradOptions)
            texts.push_back(VradHelp(option));
        return texts;
    }();
    SettingSection section{"Options of VRAD",
                           "The light stage accepts these options for users who come from Source, see [Coming from "
                           "Source](../guide/from_source_engine.md). Some of them become other options, which the run "
                           "prints. The others do nothing, and a warning names what to use instead.",
                           {},
                           "vrad"};
    for (std::size_t i = 0; i < std::size(kVradOptions); ++i) {
        SettingInfo info = kVradOptions[i].Info();
        info.help = helps[i];
        section.entries.push_back({info, ""});
    }
    return section;
}

} // namespace q3
