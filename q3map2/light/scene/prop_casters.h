// GPL-2.0-or-later. Static props as shadow casters.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/shader/shader_info.h"

#include <array>
#include <vector>

namespace q3 {

/// Triangles of a static prop with one shader, in the world. Its surface number among shadow casters is the number of
/// draw surfaces plus its index in PropShadows::casters.
struct PropCaster {
    int prop = 0; ///< number of the prop, for RayPacket::ignoredProp
    const ShaderInfo *shader = nullptr;
    bool seeThrough = false; ///< by the texels of the shader's image
    int castShadows = 1;     ///< shadow group
    std::vector<std::array<Vec3f, 3>> corners;
    std::vector<std::array<float, 6>> st; ///< of corners
};

/// What static props mean for shadows.
struct PropShadows {
    std::vector<PropCaster> casters;
    std::vector<int> receiveShadows; ///< shadow groups of the props that are lit
};

} // namespace q3
