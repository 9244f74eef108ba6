// GPL-2.0-or-later. Slots of surfaces for the styles of bounced light.
#pragma once

#include "q3map2/lightmap/raw/style_choice.h"
#include "q3map2/lightmap/raw/style_slots.h"

#include <algorithm>

namespace q3 {

/// Bounced light of a style on a surface.
struct StyleEnergy {
    double sum = 0; ///< of luminance over receivers
    float most = 0; ///< greatest channel anywhere, byte scale
};
StyleEnergy EnergyOf(std::span<const Vec3f> light);

/// Light is that of all receivers of a surface.
template <typename Light> struct BouncedStyle {
    std::uint8_t style;
    StyleEnergy energy;
    Light light;
    std::size_t slot = kStyles; ///< that ClaimSlots found; kStyles: none
};

/// The slot for a style of which no light came to the surface before.
std::size_t ClaimSlot(std::uint8_t style, const StyleEnergy &energy, Styles &styles, std::vector<std::string> &dropped);

/// Finds the slots of styles in a surface. Styles that direct light brought there keep theirs; free ones go to styles
/// with at least 1/16 byte of light somewhere, those with most light first. dropped: names the light for which no slot
/// is left.
template <typename Light>
void ClaimSlots(std::vector<BouncedStyle<Light>> &found, Styles &styles, std::vector<std::string> &dropped) {
    std::stable_sort(found.begin(), found.end(),
                     [](const auto &a, const auto &b) { return a.energy.sum > b.energy.sum; });
    for (BouncedStyle<Light> &one : found)
        one.slot = ClaimSlot(one.style, one.energy, styles, dropped);
}

} // namespace q3
