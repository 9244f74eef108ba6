// GPL-2.0-or-later. Vertices of draw surfaces and models before they are records of a file.
#pragma once

#include "libs/math/vec.h"

#include <array>
#include <cstdint>

namespace q3 {

/// Vertex of a draw surface during the bsp stage, or of a model.
struct DrawVert {
    Vec3f xyz, normal;
    std::array<float, 2> st{};
    std::array<std::uint8_t, 4> color{255, 255, 255, 255};
    bool inserted = false; ///< by T-junction repair
};

} // namespace q3
