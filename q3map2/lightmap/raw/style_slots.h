// GPL-2.0-or-later. The light styles of a surface.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

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

} // namespace q3
