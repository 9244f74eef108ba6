// GPL-2.0-or-later. Styles of lights that play a pattern or that the game switches.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/entities.h"

#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>

namespace q3 {

/// Numbers for the styles of lights that need one: all lights with one pattern share a style, and under -switchable
/// those of one targetname.
class LightStyles {
  public:
    LightStyles() = default;
    /// Styles in `taken`, those of keys of lights, and those with an rgbGen or alphaGen in `world` are not given to
    /// others. Conflicts between keys are warnings. Errors: Error, for a bad pattern and if all 254 styles are taken.
    LightStyles(std::span<const Entity> lights, const Entity &world, bool switchable, std::set<int> taken, Log &log);

    /// Sets the key style of a light that has a pattern or can be switched.
    void Set(Entity &light) const;
    /// Replaces the keys of worldspawn that an earlier run wrote, IsStyleKey.
    void Record(Entity &world) const;

  private:
    struct Group {
        int style = 0;
        std::string pattern;
        bool isSwitch = false, dark = false;
    };
    /// What lights of a group have in common, case folded; empty: the light is in none.
    std::string NameOf(const Entity &light) const;
    bool IsSwitch(const Entity &light) const;
    bool StartsDark(const Entity &light) const;
    void Add(const Entity &light, Log &log);
    void Number(std::set<int> taken);
    void WarnOfConflicts(Log &log) const;

    bool switchable_ = false;
    std::map<std::string, Group> groups_; ///< by NameOf
    std::vector<std::string> order_;      ///< names by first light
};

} // namespace q3
