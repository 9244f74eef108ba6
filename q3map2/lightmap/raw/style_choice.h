// GPL-2.0-or-later. Which light styles a surface keeps if more than it can hold reach it.
#pragma once

#include "common/log.h"
#include "q3map2/light/sources/light_sources.h"

#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace q3 {

/// Names of the lights that surfaces do without, by surface.
using DroppedLights = std::vector<std::vector<std::string>>;

/// Chooses styles by the light that they give a surface.
class StyleChoice {
  public:
    /// Whether the lights have more styles than a surface can hold, so that there is something to choose.
    static bool IsNeeded(std::span<const Light *const> lights);

    /// `energy`: the sum of all light that this one gives the surface; lights without energy are ignored.
    void Add(const Light &light, double energy);
    /// Keeps style 0 and the three others that give most; of equal ones those with lower numbers.
    void Choose();
    bool Drops(int style) const { return dropped_.contains(style); }
    /// Names of lights whose style is dropped, each once, in the order of Add.
    std::vector<std::string> Names() const;

  private:
    std::map<int, double> energies_; ///< by style
    std::vector<const Light *> lights_;
    std::set<int> dropped_;
};

/// Warns of the lights that some surfaces do without, those of many surfaces first. kind: of warning. what: the
/// surfaces, in the plural.
void WarnOfDroppedLights(const DroppedLights &dropped, std::string_view light, std::string_view what, Log &log);

} // namespace q3
