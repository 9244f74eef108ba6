// GPL-2.0-or-later. Assigns style slots of surfaces to bounced light.
#include "q3map2/lightmap/bounce/bounced_styles.h"

#include "libs/math/color.h"

namespace q3 {

namespace {

/// A style takes no slot of a surface where all its light is below this. Byte scale.
constexpr float kLeastStyleLight = 1.0f / 16;

} // namespace

StyleEnergy EnergyOf(std::span<const Vec3f> light) {
    StyleEnergy energy;
    for (const Vec3f &one : light) {
        energy.sum += double(Luminance(one));
        energy.most = std::max(energy.most, MaxComponent(one));
    }
    return energy;
}

std::size_t ClaimSlot(std::uint8_t style, const StyleEnergy &energy, Styles &styles,
                      std::vector<std::string> &dropped) {
    const std::size_t known = FindStyleSlot(styles, style);
    if (known < kStyles || energy.most < kLeastStyleLight)
        return known;
    const std::size_t slot = FindStyleSlot(styles, kNoStyle);
    if (slot < kStyles)
        styles[slot] = style;
    else
        dropped.push_back(fmt::format("light of style {}", style));
    return slot;
}

} // namespace q3
