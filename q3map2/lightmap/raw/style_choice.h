// GPL-2.0-or-later. Chooses the light styles that a surface keeps if more reach it than it can hold.
#pragma once

#include "common/log.h"
#include "q3map2/light/sources/light_sources.h"

#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace q3 {

/// Names of the lights that were left out, by surface.
using DroppedLights = std::vector<std::vector<std::string>>;

/// Chooses the styles that give a surface most light.
class StyleChoice {
  public:
    /// Whether the lights and style 0 make more styles than a surface can hold.
    static bool IsNeeded(std::span<const Light *const> lights);

    /// energy: sum of the light that `light` gives the surface; lights with 0 are ignored.
    void Add(const Light &light, double energy);
    /// Keeps style 0 and the three others that give most light; on a tie, those with lower numbers.
    void Choose();
    bool Drops(int style) const { return dropped_.contains(style); }
    /// Names of lights whose style is dropped, each once, in the order of Add.
    std::vector<std::string> Names() const;

  private:
    std::map<int, double> energies_; ///< by style
    std::vector<const Light *> lights_;
    std::set<int> dropped_;
};

/// Warns of lights that were left out of some surfaces, those left out most often first. light: the kind of light, such
/// as "bounced light". what: plural of the kind of surface, such as "lightmaps".
void WarnOfDroppedLights(const DroppedLights &dropped, std::string_view light, std::string_view what, Log &log);

} // namespace q3
