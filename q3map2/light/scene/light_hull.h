// GPL-2.0-or-later. The closed surface of everything solid, from the BSP tree.
#pragma once

#include "libs/math/winding.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/light/scene/tree_walk.h"

#include <array>
#include <span>
#include <vector>

namespace q3 {

/// Corners of a triangle. Game units.
using TriangleCorners = std::array<Vec3d, 3>;

/// By leaf: whether it is solid.
std::vector<bool> SolidLeafs(const Bsp &bsp);

/// Polygons between solid and open leafs: everything that blocks light as a volume, as a closed surface. They overlap
/// slightly, so that no ray slips through where they meet.
struct SolidHull {
    std::vector<bool> solidLeafs; ///< by leaf: whether it counts as solid
    std::vector<Winding<double>> faces;
};
/// Sets the faces of several hulls of one map. Iterative; time grows with nodes times depth.
void SolidHulls(const Bsp &bsp, std::span<SolidHull> hulls);

/// Cuts the triangle by the tree and adds to each leaf's count the number of triangles that its piece there makes. A
/// triangle within epsilon (game units) of a node's plane goes to the side that it faces.
void CountTriangles(TreeWalk<double> &tree, const TriangleCorners &triangle, double epsilon, std::vector<int> &counts);
/// Whether all leafs right behind the triangle are solid. solidInSecond: whether they are so in secondSolidLeafs too;
/// valid if the result is true.
bool SolidBehind(TreeWalk<double> &tree, const TriangleCorners &triangle, const std::vector<bool> &solidLeafs,
                 const std::vector<bool> &secondSolidLeafs, bool &solidInSecond);

} // namespace q3
