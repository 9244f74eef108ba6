// GPL-2.0-or-later. Curved surfaces as meshes.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bspfile.h"

#include <array>
#include <vector>

namespace q3 {

struct MeshVert {
    Vec3f xyz, normal;
    std::array<float, 2> st{};
};

/// Rows of `width` vertices, `height` of them.
struct Mesh {
    int width = 0, height = 0;
    std::vector<MeshVert> verts;
    const MeshVert &At(int x, int y) const { return verts[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
};

/// The mesh that the established program lights a patch with; longestCurve in game units decides how fine.
Mesh TessellatePatch(const Bsp &bsp, const bspDrawSurface_t &surface, float longestCurve);

/// Longest curve of the patch from its control points, for a map without a .srf file.
float LongestCurve(const Bsp &bsp, const bspDrawSurface_t &surface);

/// Corners of the quad at (x, y), clockwise seen from the front, starting so that its triangles are (0, 1, 2) and (0,
/// 2, 3).
std::array<MeshVert, 4> MeshQuad(const Mesh &mesh, int x, int y);

} // namespace q3
