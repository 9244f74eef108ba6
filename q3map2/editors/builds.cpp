// GPL-2.0-or-later. Entries of the build menus of level editors.
#include "q3map2/editors/builds.h"

#include <fmt/format.h>

namespace q3 {

namespace {

std::string Capitalized(std::string_view word) {
    std::string text(word);
    if (!text.empty() && text[0] >= 'a' && text[0] <= 'z')
        text[0] = char(text[0] - 'a' + 'A');
    return text;
}

EditorBuild WholeBuild(std::string_view preset, bool sh) {
    return {.label = fmt::format("{}{}: bsp, vis, light", Capitalized(preset), sh ? " with SH grid" : ""),
            .steps = {fmt::format("-bsp -preset {}", preset), fmt::format("-vis -preset {} -saveprt", preset),
                      fmt::format("-light -preset {}{}", preset, sh ? " -shbspx" : "")},
            .opensGroup = !sh};
}

EditorBuild GridBuild(std::string_view preset) {
    return {.label = fmt::format("SH grid only, {}", preset),
            .steps = {fmt::format("-light -preset {} -onlygrid -shbspx", preset)}};
}

} // namespace

bool ReadsMapSource(std::string_view step) {
    return step.starts_with("-bsp");
}

std::vector<EditorBuild> EditorBuilds(std::span<const std::string_view> presets) {
    std::vector<EditorBuild> builds;
    for (const std::string_view preset : presets)
        for (const bool sh : {false, true})
            builds.push_back(WholeBuild(preset, sh));
    builds.front().opensGroup = false;
    const std::size_t first = builds.size();
    for (const std::string_view preset : presets)
        builds.push_back(GridBuild(preset));
    builds[first].opensGroup = true;
    builds.push_back({.label = "Geometry alone, to find leaks",
                      .steps = {fmt::format("-bsp -preset {} -leaktest", presets.front())},
                      .opensGroup = true});
    builds.push_back({.label = "Entities only", .steps = {"-bsp -onlyents"}});
    builds.push_back({.label = "Package (pk3)", .steps = {R"(-pk3 -basepak "pak*.pk3")"}, .needsMap = false});
    return builds;
}

} // namespace q3
