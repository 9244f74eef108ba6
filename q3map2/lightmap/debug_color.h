// GPL-2.0-or-later. Colours that tell numbers apart in the debug modes.
#pragma once

#include "libs/math/vec.h"

#include <array>
#include <cstddef>

namespace q3 {

/// One of twelve colours, byte scale. number >= 0.
inline Vec3f DebugColor(int number) {
    constexpr std::array<std::array<float, 3>, 12> kColors = {{{255, 0, 0},
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
    return Vec3f(kColors[std::size_t(number) % kColors.size()]);
}

} // namespace q3
