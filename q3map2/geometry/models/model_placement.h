// GPL-2.0-or-later. How a model is placed in the map.
#pragma once

#include "q3map2/map/map.h"
#include "q3map2/model/model_skin.h"
#include "q3map2/model/model_transform.h"

#include <string>

namespace q3 {

/// Spawnflags of misc_model.
enum ModelFlags : unsigned {
    kModelRenameRmg = 1,
    kModelClip = 2,
    kModelForceMeta = 4,
    kModelClipFaceNormals = 8,
    kModelClipTerrain = 16,
    kModelColorToAlpha = 32,
    kModelClipVertexNormals = 128,
    kModelClipPyramid = 256,
    kModelClipDown = 512,
    kModelClipUp = 1024,
    kModelClipFull = 2048,
    kModelClipAxialBack = 4096
};
/// Flags that select the shape of clip brushes.
inline constexpr unsigned kModelClipShapes = kModelClipFaceNormals | kModelClipTerrain | kModelClipVertexNormals |
                                             kModelClipPyramid | kModelClipDown | kModelClipUp | kModelClipFull |
                                             kModelClipAxialBack;

/// A model with its transform and settings.
struct ModelPlacement {
    std::string name;
    std::string who; ///< MapEntity::MessagePrefix of its entity, for messages
    int frame = 0;
    ModelTransform transform;
    SurfaceSettings settings;
    unsigned flags = 0;
    double clipDepth = 2;
    ShaderRemap shaders;
    int fogNum = -1;
};

} // namespace q3
