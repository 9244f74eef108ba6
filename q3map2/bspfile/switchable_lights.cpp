// GPL-2.0-or-later. Switchable lights of games whose engines switch light styles: their numbers in a .bsp.
#include "q3map2/bspfile/switchable_lights.h"

#include "common/error.h"
#include "common/text/text.h"
#include "common/text/text_scan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <vector>

namespace q3 {

namespace {

/// Key that games read: the style of the light while it is on.
constexpr std::string_view kSwitchedStyle = "switch_style";

/// As games read it, which do not know the alias _targetname of the compiler.
std::string_view TargetName(const Entity &entity) {
    return entity.Value("targetname");
}

std::string NameOf(const SwitchGroup &group) {
    return group.second == 0 ? group.first : fmt::format("{} of style {}", group.first, group.second);
}

std::map<SwitchGroup, int> NumberedGroups(std::span<const Entity> entities) {
    std::map<SwitchGroup, int> styles;
    for (const Entity &entity : entities)
        if (const int style = SwitchStyle(entity); style != 0)
            styles[GroupOfNumbered(entity)] = style;
    return styles;
}

} // namespace

bool IsSwitchableLight(const Entity &entity) {
    return IsLight(entity) && !TargetName(entity).empty();
}

int StyleInFile(const Entity &light) {
    constexpr double kMost = 1e6; // callers refuse such numbers
    return int(std::clamp(light.Number({"_style", "style"}), -kMost, kMost));
}

int SwitchStyle(const Entity &entity) {
    if (!IsSwitchableLight(entity))
        return 0;
    const int style = StyleInFile(entity);
    return style >= kFirstSwitchStyle && style <= kLastStyle ? style : 0;
}

SwitchGroup GroupOfNumbered(const Entity &light) {
    return {LowerCase(TargetName(light)), StrictInteger(light.Value(kSwitchedStyle)).value_or(0)};
}

void NumberSwitchableLights(std::span<Entity *const> lights, std::string_view mapName) {
    std::vector<SwitchGroup> groups;
    for (Entity *light : lights) {
        if (!IsSwitchableLight(*light))
            continue;
        const SwitchGroup group{LowerCase(TargetName(*light)), StyleInFile(*light)};
        const auto found = std::ranges::find(groups, group);
        const auto number = found - groups.begin();
        if (found == groups.end())
            groups.push_back(group);
        light->Erase("_style");
        light->Set("style", fmt::format("{}", kFirstSwitchStyle + number));
        if (group.second != 0)
            light->Set(kSwitchedStyle, fmt::format("{}", group.second));
    }
    if (groups.size() <= std::size_t(kSwitchStyleCount))
        return;
    std::vector<std::string> names;
    for (const SwitchGroup &group : groups)
        names.push_back(NameOf(group));
    throw Error("{}: {} groups of switchable lights, engines of this game have {} styles for them; lights of one "
                "targetname and style are one group: {}",
                mapName, groups.size(), kSwitchStyleCount, fmt::join(names, ", "));
}

void RestoreLightStyle(Entity &entity) {
    if (SwitchStyle(entity) == 0)
        return;
    const std::string own(entity.Value(kSwitchedStyle));
    entity.Erase(kSwitchedStyle);
    entity.Erase("_style");
    if (own.empty())
        entity.Erase("style");
    else
        entity.Set("style", own);
}

bool HaveOtherSwitches(std::span<const Entity> before, std::span<const Entity> after) {
    const std::map<SwitchGroup, int> old = NumberedGroups(before);
    return std::ranges::any_of(NumberedGroups(after), [&](const auto &group) {
        const auto found = old.find(group.first);
        return found != old.end() && found->second != group.second;
    });
}

} // namespace q3
