// GPL-2.0-or-later. Assigns style slots of surfaces to bounced light.
#pragma once

#include "q3map2/lightmap/raw/style_choice.h"
#include "q3map2/lightmap/raw/style_slots.h"

#include <algorithm>

namespace q3 {

/// How much bounced light of a style a surface receives.
struct StyleEnergy {
    double sum = 0; ///< sum of luminance over receivers, byte scale
    float most = 0; ///< largest channel at any receiver, byte scale
};
StyleEnergy EnergyOf(std::span<const Vec3f> light);

/// Bounced light of one style on a surface. Light: a container with the light of all its receivers.
template <typename Light> struct BouncedStyle {
    std::uint8_t style;
    StyleEnergy energy;
    Light light;
    std::size_t slot = kStyles; ///< set by ClaimSlots; kStyles: none
};

/// The slot that holds the style already, else a free one, else kStyles: ClaimSlots for one style.
std::size_t ClaimSlot(std::uint8_t style, const StyleEnergy &energy, Styles &styles, std::vector<std::string> &dropped);

/// Assigns slots of a surface to styles. Styles of its direct light keep their slots; free slots go to styles with at
/// least 1/16 byte of light at some receiver, in descending order of light. Appends to `dropped` the names of styles
/// for which no slot is left.
template <typename Light>
void ClaimSlots(std::vector<BouncedStyle<Light>> &found, Styles &styles, std::vector<std::string> &dropped) {
    std::stable_sort(found.begin(), found.end(),
                     [](const auto &a, const auto &b) { return a.energy.sum > b.energy.sum; });
    for (BouncedStyle<Light> &one : found)
        one.slot = ClaimSlot(one.style, one.energy, styles, dropped);
}

} // namespace q3
