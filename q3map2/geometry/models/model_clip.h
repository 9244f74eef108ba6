// GPL-2.0-or-later. Clip brushes of models.
#pragma once

#include "q3map2/geometry/models/model_placement.h"
#include "q3map2/map/bsp_context.h"

#include <array>
#include <vector>

namespace q3 {

/// Mesh of a placed model, in world space.
struct ClipMesh {
    const ShaderInfo *shader = nullptr;
    std::vector<Vec3f> points, normals;
    std::vector<std::array<int, 3>> triangles;
};

/// Appends clip brushes to `target`, extruded from the polygons of the meshes; the placement's flags select the shape.
void MakeClipBrushes(const std::vector<ClipMesh> &meshes, const ModelPlacement &placement, MapEntity &target,
                     PlaneTable &planes, const BspContext &context);

} // namespace q3
