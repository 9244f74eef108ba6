// GPL-2.0-or-later. Styles of lights that play a pattern or that the game switches.
#include "q3map2/light/sources/light_styles.h"

#include "common/error.h"
#include "q3map2/bspfile/light_curve_keys.h"
#include "q3map2/bspfile/light_style_keys.h"
#include "q3map2/bspfile/written_keys.h"
#include "q3map2/light/sources/light_curves.h"
#include "q3map2/light/sources/style_wave.h"

#include <initializer_list>
#include <utility>

namespace q3 {

namespace {

constexpr int kEndOfStyles = 255;
/// Styles from the first to before the second.
using StyleRange = std::pair<int, int>;
/// Engines of Quake's family know the patterns of styles up to 11 by heart and switch those from 32 to 62.
constexpr StyleRange kKnown{1, 12}, kBetween{12, 32}, kSwitches{32, 63}, kFree{63, kEndOfStyles};

/// The first style in the ranges that is not taken.
int FreeStyle(std::initializer_list<StyleRange> ranges, const std::set<int> &taken) {
    for (const auto &[first, end] : ranges)
        for (int style = first; style < end; ++style)
            if (!taken.contains(style))
                return style;
    throw Error("all {} light styles are taken; patterns and switchable lights need more", kEndOfStyles - 1);
}

/// Name of the group of a pattern; no targetname begins like this.
std::string PatternGroup(std::string_view pattern) {
    return "\n" + LowerCase(pattern);
}

} // namespace

LightStyles::LightStyles(std::span<const Entity> lights, const Entity &world, bool switchable, std::set<int> taken,
                         Log &log)
    : switchable_(switchable) {
    for (const auto &[key, value] : world.pairs)
        for (const std::string_view end : {"rgbgen", "alphagen"})
            taken.insert(StyleOfKey(key, "_style", end));
    for (const Entity &light : lights) {
        taken.insert(keys::kStyle.Integer(light));
        Add(light, log);
    }
    Number(std::move(taken));
    WarnOfConflicts(log);
}

bool LightStyles::IsSwitch(const Entity &light) const {
    return switchable_ && keys::kSwitchName.Given(light);
}

std::string LightStyles::NameOf(const Entity &light) const {
    if (IsSwitch(light))
        return std::string(keys::kSwitchName.Text(light));
    return keys::kPattern.Given(light) ? PatternGroup(keys::kPattern.Text(light)) : std::string();
}

bool LightStyles::StartsDark(const Entity &light) const {
    return IsSwitch(light) && CountsInBytes(light) && (keys::kSpawnFlags.Integer(light) & 1) != 0;
}

void LightStyles::Add(const Entity &light, Log &log) {
    const std::string name = NameOf(light), pattern = LowerCase(keys::kPattern.Text(light));
    if (name.empty())
        return;
    try {
        if (!pattern.empty())
            BrightnessOf(pattern);
    } catch (const Error &error) {
        throw Error("{}: {}", LightLabel(light), error.what());
    }
    const bool first = !groups_.contains(name);
    Group &group = groups_[name];
    if (first) {
        order_.push_back(name);
        group = {.pattern = pattern, .isSwitch = IsSwitch(light), .dark = StartsDark(light)};
    } else if (group.pattern != pattern || group.dark != StartsDark(light))
        log.Warn("lights of one targetname", "{}: other lights of targetname \"{}\" have another {}; the first counts",
                 LightLabel(light), name, group.pattern != pattern ? "pattern" : "spawnflag for dark at first");
    const int style = keys::kStyle.Integer(light);
    if (group.style != 0 && style != 0 && group.style != style)
        log.Warn("style of a group of lights", "{}: style {} is not used, lights of the same {} have style {}",
                 LightLabel(light), style, group.isSwitch ? "targetname" : "pattern", group.style);
    else if (group.style == 0)
        group.style = style;
}

void LightStyles::Number(std::set<int> taken) {
    for (const std::string &name : order_) {
        Group &group = groups_[name];
        if (group.style == 0)
            group.style = group.isSwitch ? FreeStyle({kSwitches, kFree, kBetween, kKnown}, taken)
                                         : FreeStyle({kBetween, kFree, kKnown, kSwitches}, taken);
        taken.insert(group.style);
    }
}

void LightStyles::WarnOfConflicts(Log &log) const {
    std::map<int, const Group *> byStyle;
    for (const std::string &name : order_) {
        const Group &group = groups_.at(name);
        const Group &first = *byStyle.try_emplace(group.style, &group).first->second;
        if (first.pattern != group.pattern)
            log.Warn("patterns of one style", "style {} has the patterns \"{}\" and \"{}\"; the first counts",
                     group.style, first.pattern, group.pattern);
    }
}

void LightStyles::Set(Entity &light) const {
    const std::string name = NameOf(light);
    const auto group = name.empty() ? groups_.end() : groups_.find(name);
    if (group == groups_.end())
        return;
    light.Erase("_style");
    light.Set("style", fmt::format("{}", group->second.style));
}

void LightStyles::Record(Entity &world) const {
    std::erase_if(world.pairs, [](const auto &pair) { return IsStyleKey(pair.first); });
    for (const std::string &name : order_) {
        const Group &group = groups_.at(name);
        if (!group.pattern.empty() && !world.Has(PatternKey(group.style)))
            world.Set(PatternKey(group.style), group.pattern);
        if (!group.isSwitch)
            continue;
        const std::string key = SwitchKey(group.style), before(world.Value(key));
        world.Set(key, before.empty() ? name : before + " " + name);
        if (group.dark)
            world.Set(DarkKey(group.style), "1");
    }
}

} // namespace q3
