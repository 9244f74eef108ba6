// GPL-2.0-or-later. Switchable lights of games whose engines switch light styles: their numbers in a .bsp.
#include "q3map2/map/switchable_lights.h"

#include "common/error.h"
#include "common/text/text.h"
#include "common/text/text_scan.h"
#include "q3map2/bspfile/map_keys.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace q3 {

namespace {

constexpr int kEngineStyles = kFirstSwitchStyle + kSwitchStyleCount;
constexpr std::string_view kSwitchedStyle = "switch_style"; ///< key: style of the light while it is on

/// Targetname and own style.
using SwitchGroup = std::pair<std::string, int>;

bool IsLight(const Entity &entity) {
    return StartsWithNoCase(entity.ClassName(), "light");
}

int StyleInFile(const Entity &light) {
    constexpr double kMost = 1e6; // other numbers are refused all the same
    return int(std::clamp(light.Number({"_style", "style"}), -kMost, kMost));
}

std::string NameOf(const SwitchGroup &group) {
    return group.second == 0 ? group.first : fmt::format("{} of style {}", group.first, group.second);
}

std::map<SwitchGroup, int> NumberedGroups(std::span<const Entity> entities) {
    std::map<SwitchGroup, int> styles;
    for (const Entity &entity : entities)
        if (IsSwitchableLight(entity))
            styles[{std::string(keys::kTargetName.Text(entity)),
                    StrictInteger(entity.Value(kSwitchedStyle)).value_or(0)}] = StyleInFile(entity);
    return styles;
}

} // namespace

bool IsSwitchableLight(const Entity &entity) {
    return IsLight(entity) && keys::kTargetName.Given(entity);
}

void NumberSwitchableLights(Map &map) {
    std::vector<SwitchGroup> groups;
    for (MapEntity &entity : map.entities) {
        if (!IsLight(entity.pairs))
            continue;
        RestoreLightStyle(entity.pairs); // entities may come from a .bsp
        if (const int own = StyleInFile(entity.pairs); own >= kEngineStyles)
            throw Error("{}: light style {}, expected 0 to {}: engines of this game have no others",
                        entity.MessagePrefix(), own, kEngineStyles - 1);
        if (!IsSwitchableLight(entity.pairs))
            continue;
        const SwitchGroup group{keys::kTargetName.Text(entity.pairs), keys::kStyle.Integer(entity.pairs)};
        const auto found = std::ranges::find(groups, group);
        const auto number = found - groups.begin();
        if (found == groups.end())
            groups.push_back(group);
        entity.pairs.Erase("_style");
        entity.pairs.Set("style", fmt::format("{}", kFirstSwitchStyle + number));
        if (group.second != 0)
            entity.pairs.Set(kSwitchedStyle, fmt::format("{}", group.second));
    }
    if (groups.size() <= std::size_t(kSwitchStyleCount))
        return;
    std::vector<std::string> names;
    for (const SwitchGroup &group : groups)
        names.push_back(NameOf(group));
    throw Error("{}: {} groups of switchable lights, engines of this game have {} styles for them; lights of one "
                "targetname and style are one group: {}",
                map.name, groups.size(), kSwitchStyleCount, fmt::join(names, ", "));
}

void RestoreLightStyle(Entity &entity) {
    const int style = StyleInFile(entity);
    if (!IsSwitchableLight(entity) || style < kFirstSwitchStyle || style >= kEngineStyles)
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
