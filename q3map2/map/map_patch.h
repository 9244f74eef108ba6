// GPL-2.0-or-later. Curve detail, normals and tessellation of patches.
#pragma once

#include "q3map2/map/map.h"

#include <array>
#include <deque>
#include <vector>

namespace q3 {

/// Sets longestCurve and lodBounds of each patch to those of its group: the patches that it touches, directly or by a
/// chain of others. Engines choose the same level of detail for patches with equal values.
void FinishPatches(std::deque<Patch> &patches);
/// Sets normals of control points, from neighboring control points and from the curve.
void SetPatchNormals(Patch &patch);

/// Triangle mesh of a patch.
struct PatchMesh {
    int width = 0, height = 0;
    std::vector<DrawVert> verts; ///< row * width + column
};
/// Tessellates a patch for a curve tolerance of `subdivisions` game units.
PatchMesh TessellatePatch(const Patch &patch, int subdivisions);
/// Corner indexes of the triangles of a mesh, clockwise seen from the front.
std::vector<std::array<int, 3>> MeshTriangles(const PatchMesh &mesh);

} // namespace q3
