// GPL-2.0-or-later. Named sets of options.
#include "q3map2/presets.h"

#include "common/error.h"
#include "common/nearest_names.h"
#include "common/text/text.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <sstream>

namespace q3 {

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
     .help = "For play tests: soft shadow edges and two bounces",
     .bsp = "-meta",
     .vis = "",
     .light = "-fast -samples 2 -bounce 2 -bouncegrid",
     .gridSH = "-gridsh 64 64 64"},
    {.name = "final",
     .help = "For release: nothing is left out for speed, and the SH grid is small and fitted",
     .bsp = "-meta",
     .vis = "",
     .light = "-patchshadows -samples 3 -bounce inf -bouncegrid",
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

/// Whether the line asks for an SH grid and leaves its cell to the preset.
bool TakesGridSH(const std::vector<std::string> &words) {
    constexpr std::string_view kGrids[] = {"-sh", "-shbspx", "-shradiance", "-gridformats"};
    return !HasWord(words, "-shsmall") &&
           std::ranges::any_of(kGrids, [&](std::string_view option) { return HasWord(words, option); });
}

const Preset &FindPreset(std::string_view name) {
    const auto found = std::ranges::find_if(kPresets, [&](const Preset &p) { return EqualNoCase(p.name, name); });
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

} // namespace q3
