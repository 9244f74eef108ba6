// GPL-2.0-or-later. Clip brushes of models: solids behind their polygons.
#pragma once

#include "libs/math/winding.h"
#include "q3map2/geometry/models/models.h"
#include "q3map2/map/bsp_options.h"

#include <array>
#include <span>
#include <vector>

namespace q3 {

/// Clockwise polygons. Coplanar neighbors are merged while the result is convex; degenerate triangles are
/// ignored.
std::vector<Polygon> MergedTriangles(std::span<const Vec3f> points, std::span<const std::array<int, 3>> triangles);

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
