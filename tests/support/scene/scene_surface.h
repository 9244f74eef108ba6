// GPL-2.0-or-later. Surfaces of boxes. Internal to the folder.
#pragma once

#include "tests/support/scene/scene_builder.h"

namespace q3 {

inline constexpr float kSceneTextureSize = 64; ///< game units that one repeat of a texture covers

/// One side of a box as a quad, clockwise seen from outside the box.
SceneBuilder::Surface BoxFaceSurface(const Boundsf &bounds, BoxFace face, const SceneShader &shader);

} // namespace q3
