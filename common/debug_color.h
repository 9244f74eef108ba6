// GPL-2.0-or-later. Colors that distinguish indices in the debug modes.
#pragma once

#include "libs/math/vec.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace q3 {

/// One of twelve colors, 8 bits a channel. Consecutive numbers differ.
inline std::array<std::uint8_t, 3> DebugColorBytes(std::size_t number) {
    constexpr std::array<std::array<std::uint8_t, 3>, 12> kColors = {{{255, 0, 0},
                                                                      {192, 128, 128},
                                                                      {255, 255, 0},
                                                                      {192, 192, 128},
                                                                      {0, 255, 255},
                                                                      {128, 192, 192},
                                                                      {0, 0, 255},
                                                                      {128, 128, 192},
                                                                      {255, 0, 255},
                                                                      {192, 128, 192},
                                                                      {0, 255, 0},
                                                                      {128, 192, 128}}};
    return kColors[number % kColors.size()];
}
/// The same as floats from 0 to 255. number >= 0.
inline Vec3f DebugColor(int number) {
    const auto [r, g, b] = DebugColorBytes(std::size_t(number));
    return {float(r), float(g), float(b)};
}

} // namespace q3
