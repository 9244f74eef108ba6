// GPL-2.0-or-later. The light styles of a surface: slots, and the choice if more reach it than it can hold.
#pragma once

#include "common/log.h"
#include "q3map2/light/sources/light_sources.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace q3 {

/// Light styles that one surface can hold.
inline constexpr std::size_t kStyles = 4;
/// Style by slot; slot 0 holds style 0, and free slots come last.
using Styles = std::array<std::uint8_t, kStyles>;
/// Marks a free slot.
inline constexpr std::uint8_t kNoStyle = 255;
inline constexpr Styles kOnlyStyle0{0, kNoStyle, kNoStyle, kNoStyle};

/// The slot that holds the style; kStyles if none does.
inline std::size_t FindStyleSlot(const Styles &styles, int style) {
    return std::size_t(std::find(styles.begin(), styles.end(), style) - styles.begin());
}

/// The slot that holds the style, else the first free one; kStyles if other styles hold all.
inline std::size_t StyleSlotFor(const Styles &styles, int style) {
    const std::size_t known = FindStyleSlot(styles, style);
    return known < kStyles ? known : FindStyleSlot(styles, kNoStyle);
}

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
