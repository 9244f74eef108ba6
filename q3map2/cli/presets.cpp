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

// docs/ship_sh.md has error and size of these SH grids.
constexpr std::array<Preset, 3> kPresets{{
    {.name = "draft",
     .help = "To see at once what a change does",
     .bsp = "-meta -samplesize 32",
     .vis = "-fast",
     .light = "-faster",
     .gridSH = "-gridsh 64 64 128"},
    {.name = "normal",
     .help = "For play tests: soft shadows and two bounces",
     .bsp = "-meta",
     .vis = "",
     .light = "-fast -areashadows 64 -samples 2 -bounce 2 -bouncegrid",
     .gridSH = "-gridsh 64 64 64"},
    {.name = "final",
     .help = "For release: nothing is left out for speed, and the SH grid is small and fitted",
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

/// Whether the line asks for an SH grid and leaves the size of its cells to the preset.
bool TakesGridSH(const std::vector<std::string> &words) {
    constexpr std::string_view kGridOptions[] = {"-sh",         "-shbspx",   "-shradiance",
                                                 "-shadaptive", "-shbudget", "-gridformats"};
    return !HasWord(words, "-shsmall") &&
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
    static constexpr SettingInfo kInfo{
        .name = "-preset",
        .values = "draft|normal|final",
        .kind = SettingKind::Choice,
        .help = "A set of options; others on the line come on top and override it",
        .details = "[presets.md](presets.md) lists them. The run prints what the preset stands for."};
    return {"Preset", "", {{kInfo, "none"}}};
}

// ---- Options of VRAD ----

namespace {

constexpr VradOption kVradOptions[] = {
    {"-final", 0, "-preset final", "the preset for release"},
    {"-extra", 0, "-samples 2", "adaptive samples at shadow edges"},
    {"-noextra", 0, "-samples 1", "one sample a luxel"},
    {"-fastambient", 0, "-cubesperleaf 1", "one ambient cube a leaf"},
    {"-smooth", 1, "-shade -shadeangle N", "phong shading below that angle"},
    {"-reflectivityscale", 1, "-bouncescale N", "factor of reflected light"},
    {"-chop", 1, "", "radiosity is solved by luxel: -samplesize sets their size, -bouncerays the quality"},
    {"-maxchop", 1, "", "radiosity is solved by luxel: -samplesize sets their size, -bouncerays the quality"},
    {"-dispchop", 1, "", "radiosity is solved by luxel: -samplesize sets their size, -bouncerays the quality"},
    {"-maxdispchop", 1, "", "radiosity is solved by luxel: -samplesize sets their size, -bouncerays the quality"},
    {"-choptexlights", 1, "", "surface lights are divided by q3map_lightSubdivide"},
    {"-softsun", 1, "", "SunSpreadAngle of light_environment, or the deviance of q3map_sunExt"},
    {"-extrasky", 1, "", "_samples of light_environment, or the iterations of q3map_skylight"},
    {"-extrapasses", 1, "", "-samples N"},
    {"-luxeldensity", 1, "", "-samplescale N: 2 halves the density"},
    {"-centersamples", 0, "", "samples are at the centers of luxels"},
    {"-ambient", 3, "", "_ambient of worldspawn"},
    {"-maxlight", 1, "", "_maxlight of worldspawn"},
    {"-dlight", 1, "", "surface lights shine as far as their light lasts"},
    {"-noskyboxrecurse", 0, "", "rays end at the sky"},
    {"-nodetaillight", 0, "", "there are no detail props"},
    {"-onlydetail", 0, "", "there are no detail props"},
    {"-nossprops", 0, "", "without -staticproppolys props do not cast shadows by their triangles"},
    {"-staticpropnormals", 0, "", "-debugnormals shows the normals of luxels"},
    {"-dumpnormals", 0, "", "-debugnormals shows the normals of luxels"},
    {"-debugextra", 0, "", "-debug shows luxels that were moved or filled"},
    {"-rederrors", 0, "", "-debug shows luxels that were moved or filled"},
    {"-low", 0, "", "the priority of a process is set by the system: nice, start /low"},
    {"-mpi", 0, "", "one machine does all the work: -threads N"},
    {"-mpi_pw", 1, "", "one machine does all the work: -threads N"},
    {"-vproject", 1, "", "-fs_basepath DIR and -fs_game NAME"},
    {"-insert_search_path", 1, "", "-fs_basepath, which may be repeated"},
    {"-novconfig", 0, "", "there is no such window"},
    {"-stoponexit", 0, "", "the program never waits for a key"},
    {"-compressconstant", 0, "", "lightmaps of one color are stored as one texel"},
    {"-loghash", 0, "", "-v prints details, -report writes them as JSON"},
    {"-verbose", 0, "", "-v prints details"},
};

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
        while (const auto values = arguments.TakeValues({option.name}, std::size_t(option.values))) {
            if (option.replacement.empty()) {
                log.Warn(option.name, "{} is an option of VRAD and does nothing here: {}", option.name, option.advice);
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
            texts.push_back(option.replacement.empty() ? fmt::format("Does nothing; instead: {}", option.advice)
                                                       : fmt::format("`{}`: {}", option.replacement, option.advice));
        return texts;
    }();
    SettingSection section{
        "Options of VRAD",
        "Accepted for those who come from Source: [from_source.md](from_source.md#options). The first ones become "
        "other options, as the run says; the others have no effect, which is a warning that names what to use instead.",
        {},
        "vrad"};
    for (std::size_t i = 0; i < std::size(kVradOptions); ++i) {
        SettingInfo info{.name = kVradOptions[i].name, .help = helps[i]};
        constexpr std::string_view kValues[] = {"", "N", "N N", "R G B"};
        info.values = kValues[kVradOptions[i].values];
        info.kind = info.values.empty() ? SettingKind::Flag : SettingKind::Text;
        section.entries.push_back({info, ""});
    }
    return section;
}

} // namespace q3
